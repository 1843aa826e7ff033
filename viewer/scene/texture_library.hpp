#pragma once

#include "core/base/expected.hpp"
#include "viewer/renderer/drawing/object_look.hpp"
#include "viewer/scene/background_reader.hpp"

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
    std::size_t max_textures = 256;                   // requested; the names come from the network
    std::size_t max_pixels = std::size_t{48} << 20U;  // all textures together
};

/// Reads a PNG or JPEG file, recognised by its first bytes. Safe for untrusted files: checks the
/// size before it decodes. Errors name the file: kNotFound, or kInvalidData if it is damaged or
/// exceeds `limits`.
Expected<renderer::TexturePicture> read_texture(const std::filesystem::path& file,
                                                const TextureLimits& limits = {});

/// Loads the textures of one folder in the background. The log names each failure once. Not
/// thread-safe.
class TextureLibrary {
public:
    using Loaded = std::pair<std::string, renderer::TexturePicture>;

    explicit TextureLibrary(const std::filesystem::path& folder, const TextureLimits& limits = {});

    /// Requests a file of the folder (bus::is_valid_model_file). Ignored if it was requested since
    /// the last `forget`.
    void want(const std::string& file);
    /// Whether the file could not be read.
    bool is_missing(const std::string& file) const { return complained_.contains(file); }
    /// Returns the textures loaded since the last call. Never blocks.
    std::vector<Loaded> take();
    /// Whether everything that was requested has been read and taken.
    bool is_idle() const { return reader_.is_idle(); }
    /// Drops all requests. Files may be requested again.
    void forget();

private:
    void complain(const std::string& file, const std::string& why, const std::string& advice);

    const std::filesystem::path folder_;
    TextureLimits limits_;
    std::size_t num_pixels_ = 0;
    std::set<std::string> complained_;
    BackgroundReader<std::string, renderer::TexturePicture> reader_;
};

}  // namespace atrium::viewer
