#include "viewer/receive/pairing.hpp"

#include <algorithm>
#include <utility>

namespace atrium::viewer {

std::optional<FramePair> Pairing::add(bus::SiteMesh mesh) {
    const FrameKey key{mesh.capture_time, mesh.frame_id};
    const std::string site = mesh.site;
    PendingFrame* frame = find_or_add(site, key);
    if (frame == nullptr) return std::nullopt;
    frame->mesh = std::move(mesh);
    return hand_out_if_complete(site, key);
}

std::optional<FramePair> Pairing::add(bus::CameraTexture texture) {
    const FrameKey key{texture.capture_time, texture.frame_id};
    const std::string site = texture.site;
    PendingFrame* frame = find_or_add(site, key);
    if (frame == nullptr) return std::nullopt;
    frame->textures.insert_or_assign(texture.camera, std::move(texture));
    return hand_out_if_complete(site, key);
}

void Pairing::forget(const std::string& site) {
    const auto found = sites_.find(site);
    if (found == sites_.end()) return;
    found->second.pending.clear();
    found->second.is_gone = true;
}

std::size_t Pairing::num_pending(const std::string& site) const {
    const auto found = sites_.find(site);
    return found == sites_.end() ? 0 : found->second.pending.size();
}

Pairing::PendingFrame* Pairing::find_or_add(const std::string& site, const FrameKey& key) {
    if (sites_.size() >= options_.max_sites && !sites_.contains(site)) {
        const auto gone =
            std::ranges::find_if(sites_, [](const auto& other) { return other.second.is_gone; });
        if (gone == sites_.end()) return nullptr;
        sites_.erase(gone);
    }
    Site& entry = sites_[site];
    entry.is_gone = false;
    if (entry.last && key <= *entry.last) {
        if (entry.last->capture_time - key.capture_time <= options_.max_disorder) {
            ++num_late_;
            return nullptr;
        }
        num_incomplete_ += entry.pending.size();
        entry = {};
    }
    PendingFrame& frame = entry.pending[key];
    while (entry.pending.size() > options_.max_pending_frames) {
        const bool is_own = entry.pending.begin()->first == key;
        entry.pending.erase(entry.pending.begin());
        ++num_incomplete_;
        if (is_own) return nullptr;
    }
    return &frame;
}

std::optional<FramePair> Pairing::hand_out_if_complete(const std::string& site,
                                                       const FrameKey& key) {
    Site& entry = sites_[site];
    const auto found = entry.pending.find(key);
    PendingFrame& frame = found->second;
    if (!frame.mesh) return std::nullopt;
    const auto& wanted = frame.mesh->textured_cameras;
    if (!std::all_of(wanted.begin(), wanted.end(), [&](std::uint32_t camera) {
            return frame.textures.contains(camera);
        }))
        return std::nullopt;

    FramePair pair;
    for (const std::uint32_t camera : wanted) {
        auto node = frame.textures.extract(camera);  // empty if a camera is named twice
        if (!node.empty()) pair.textures.push_back(std::move(node.mapped()));
    }
    pair.mesh = std::move(*frame.mesh);
    num_incomplete_ += static_cast<std::uint64_t>(std::distance(entry.pending.begin(), found));
    entry.pending.erase(entry.pending.begin(), std::next(found));
    entry.last = key;
    return pair;
}

}  // namespace atrium::viewer
