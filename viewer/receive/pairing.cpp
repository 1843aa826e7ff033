#include "viewer/receive/pairing.hpp"

#include <algorithm>
#include <utility>

namespace atrium::viewer {

std::optional<FramePair> Pairing::add(bus::SiteMesh mesh) {
    const FrameKey key{mesh.capture_time, mesh.frame_id};
    const std::string site = mesh.site;
    PendingFrame* frame = find_or_add(site, key);
    if (frame == nullptr) return std::nullopt;
    note_naming(sites_[site], mesh);
    // which may have forgotten what waited
    sites_[site].pending[key].mesh = std::move(mesh);
    return hand_out_if_complete(site, key);
}

std::optional<FramePair> Pairing::add(bus::CameraTexture texture) {
    const FrameKey key{texture.capture_time, texture.frame_id};
    const std::string site = texture.site;
    if (const auto found = sites_.find(site); found != sites_.end() && found->second.names_textures)
        return keep_waiting(found->second, std::move(texture)) ? hand_out_newest(site)
                                                               : std::nullopt;
    PendingFrame* frame = find_or_add(site, key);
    if (frame == nullptr) return std::nullopt;
    frame->textures.insert_or_assign(texture.camera, std::move(texture));
    return hand_out_if_complete(site, key);
}

void Pairing::forget(const std::string& site) {
    const auto found = sites_.find(site);
    if (found == sites_.end()) return;
    found->second.pending.clear();
    for (auto& [camera, textures] : found->second.own_textures) {
        textures.waiting.clear();
        textures.arrivals.clear();
    }
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

// A site may change between one process and several hosts when it starts again.
void Pairing::note_naming(Site& site, const bus::SiteMesh& mesh) {
    const bool names = !mesh.texture_frames.empty();
    if (mesh.textured_cameras.empty() || names == site.names_textures) return;
    site.names_textures = names;
    if (!names) return site.own_textures.clear();
    auto pending = std::exchange(site.pending, {});
    for (auto& [key, frame] : pending) {
        for (auto& [camera, texture] : frame.textures) keep_waiting(site, std::move(texture));
    }
}

// Returns false if the texture comes too late.
bool Pairing::keep_waiting(Site& site, bus::CameraTexture texture) {
    OwnTextures& own = site.own_textures[texture.camera];
    const FrameKey key{texture.capture_time, texture.frame_id};
    if (own.last && key <= *own.last) {
        if (own.last->capture_time - key.capture_time <= options_.max_disorder) {
            ++num_late_;
            return false;
        }
        own = {};
    }
    own.waiting.insert_or_assign(key, std::move(texture));
    own.arrivals.push_back(key);
    // The first to come are the first to go, whatever their times: the clock of a host may have
    // been set back.
    while (own.arrivals.size() > options_.max_waiting_textures) {
        own.waiting.erase(own.arrivals.front());
        own.arrivals.pop_front();
    }
    return true;
}

Pairing::FrameKey Pairing::texture_key(const bus::SiteMesh& mesh, std::size_t index) {
    const bus::FrameKey named = bus::texture_frame(mesh, index);
    return {named.capture_time, named.frame_id};
}

// Moves the textures that the frame's mesh names to it, if all are there.
bool Pairing::collect(Site& site, PendingFrame& frame) {
    const auto& wanted = frame.mesh->textured_cameras;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (!site.own_textures[wanted[i]].waiting.contains(texture_key(*frame.mesh, i)))
            return false;
    }
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        OwnTextures& own = site.own_textures[wanted[i]];
        const auto found = own.waiting.find(texture_key(*frame.mesh, i));
        own.last = found->first;
        frame.textures.insert_or_assign(wanted[i], std::move(found->second));
        own.waiting.erase(own.waiting.begin(), std::next(found));
    }
    return true;
}

// After a texture with a key of its own: it may complete any of the meshes that wait.
std::optional<FramePair> Pairing::hand_out_newest(const std::string& site) {
    Site& entry = sites_[site];
    for (auto frame = entry.pending.rbegin(); frame != entry.pending.rend(); ++frame) {
        const FrameKey key = frame->first;
        if (auto pair = hand_out_if_complete(site, key)) return pair;
    }
    return std::nullopt;
}

std::optional<FramePair> Pairing::hand_out_if_complete(const std::string& site,
                                                       const FrameKey& key) {
    Site& entry = sites_[site];
    const auto found = entry.pending.find(key);
    PendingFrame& frame = found->second;
    if (!frame.mesh) return std::nullopt;
    const auto& wanted = frame.mesh->textured_cameras;
    if (entry.names_textures ? !collect(entry, frame)
                             : !std::all_of(wanted.begin(), wanted.end(), [&](std::uint32_t c) {
                                   return frame.textures.contains(c);
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
