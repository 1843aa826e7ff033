#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"

#include <filesystem>
#include <vector>

namespace atrium::site_node {
struct SiteFrame;
}

namespace atrium::bench {

/// Coded messages of a site, ready to be written repeatedly. The writer fills in site, ids and
/// times.
struct CodedStream {
    struct Frame {
        bus::SiteMesh mesh;
        std::vector<bus::CameraTexture> textures;
    };
    bus::SiteDescription description;
    std::vector<Frame> frames;
};

/// A coded metaframe as a site publishes it.
CodedStream::Frame to_frame(const site_node::SiteFrame& coded);

/// One second of the simulated room, coded as in a site: eight cameras of 1 MP with a mosaic and
/// noise. Takes a minute if the room is not in the cache.
Expected<CodedStream> code_simulated_person();

/// A file for other processes of this machine.
Expected<void> save(const CodedStream& stream, const std::filesystem::path& file);
Expected<CodedStream> load_coded_stream(const std::filesystem::path& file);

}  // namespace atrium::bench
