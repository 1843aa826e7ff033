#pragma once

#include "core/bus/messages.hpp"
#include "core/recording/cursor.hpp"

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::recording {

/// One frame of a site: a mesh and the textures that belong to it.
struct SiteFrame {
    Timestamp time;  // when the mesh was recorded
    bus::SiteMesh mesh;
    std::vector<bus::CameraTexture> textures;  // of mesh.textured_cameras; some may be missing
    std::shared_ptr<const bus::SiteDescription> description;
    std::optional<bus::SitePlacement> placement;  // none: it has no place in the world yet
};

/// The frames of one site of a recording, in turn, for programs that need people as messages.
class SiteFrames {
public:
    /// Frames from `begin` to `end`, both included. kNotFound if the recording has no such site:
    /// the message names those that it has.
    static Expected<SiteFrames> open(std::shared_ptr<const WorldFile> world,
                                     const std::string& site,
                                     Timestamp begin,
                                     Timestamp end);

    /// The next frame; nullopt at the end. Frames before the site's description are left out.
    std::optional<SiteFrame> next();

    /// Frames without one of their textures, so far.
    std::uint64_t num_incomplete() const { return num_incomplete_; }
    /// Samples that could not be read, so far.
    std::uint64_t num_refused() const { return num_refused_; }
    /// Chunks that could not be read, so far, and why the last of them could not.
    std::uint64_t num_damaged() const { return cursor_.num_damaged(); }
    const std::string& damage() const { return cursor_.damage(); }

private:
    SiteFrames(std::shared_ptr<const WorldFile> world,
               std::string site,
               Timestamp begin,
               Timestamp end);
    void keep(const WorldFile::Kept& kept);
    void keep_until(Timestamp time);
    std::optional<SiteFrame> complete(const PlayedSample& sample);

    std::shared_ptr<const WorldFile> world_;
    std::string site_;
    Timestamp begin_;
    Timestamp end_;
    Cursor cursor_;
    std::size_t next_kept_ = 0;
    std::shared_ptr<const bus::SiteDescription> description_;
    std::optional<bus::SitePlacement> placement_;
    std::map<std::uint32_t, std::deque<bus::CameraTexture>> textures_;  // the newest, by camera
    std::uint64_t num_incomplete_ = 0;
    std::uint64_t num_refused_ = 0;
};

}  // namespace atrium::recording
