#pragma once

#include "core/base/expected.hpp"
#include "viewer/background_reader.hpp"
#include "viewer/renderer/object_look.hpp"

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

struct TextureLimits {
    std::uintmax_t max_file_bytes = std::uintmax_t{16} << 20U;
    int max_side_px = 4096;
    std::size_t max_textures = 256;                   // asked for; names come from the network
    std::size_t max_pixels = std::size_t{48} << 20U;  // of all together
};

/// Reads a .png or .jpg as what it is from its first bytes. For files of anybody: nothing is
/// decoded before its size is known. Errors name the file: kNotFound, or kInvalidData where it is
/// damaged or beyond `limits`.
Expected<renderer::TexturePicture> read_texture(const std::filesystem::path& file,
                                                const TextureLimits& limits = {});

/// The pictures that lie on things, from files of one folder, read in the background; what cannot
/// be had is said once in the log. Not thread-safe.
class TextureLibrary {
public:
    using Loaded = std::pair<std::string, renderer::TexturePicture>;

    explicit TextureLibrary(const std::filesystem::path& folder, const TextureLimits& limits = {});

    /// Asks for a file of the folder (bus::is_valid_model_file); again only after `forget`.
    void want(const std::string& file);
    /// What has been read since the last call. Never waits.
    std::vector<Loaded> take();
    /// All that was asked for: it may be asked for again.
    void forget();

private:
    void complain(const std::string& file, const std::string& why);

    TextureLimits limits_;
    std::size_t num_pixels_ = 0;
    std::set<std::string> complained_;
    BackgroundReader<std::string, renderer::TexturePicture> reader_;
};

}  // namespace atrium::viewer
