#include "world_server/description/texture_fingerprints.hpp"

#include "core/bus/limits.hpp"

#include <map>

namespace atrium::world_server {

Fingerprint texture_fingerprint(const std::filesystem::path& folder, const std::string& texture) {
    if (texture.empty() || folder.empty()) return {};
    return fingerprint_of(folder / texture, bus::kMaxTextureFileBytes);
}

void fingerprint_textures(WorldDescription& description) {
    std::map<std::string, Fingerprint> known;
    const auto of = [&](const std::string& texture) {
        const auto [found, is_new] = known.try_emplace(texture);
        if (is_new) found->second = texture_fingerprint(description.models_folder, texture);
        return found->second;
    };
    for (WorldObject& object : description.objects)
        object.look.texture_fingerprint = of(object.look.texture);
    for (WorldSoftObject& soft : description.soft) soft.texture_fingerprint = of(soft.texture);
    for (WorldScenery& scenery : description.scenery)
        scenery.look.texture_fingerprint = of(scenery.look.texture);
}

}  // namespace atrium::world_server
