#pragma once

#include "core/base/expected.hpp"
#include "core/bus/limits.hpp"
#include "viewer/renderer/drawing/object_look.hpp"
#include "viewer/scene/background_reader.hpp"
#include "viewer/scene/file_versions.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

struct TextureLimits {
    std::uintmax_t max_file_bytes = bus::kMaxTextureFileBytes;
    int max_side_px = 4096;
    std::size_t max_textures = 256;                   // requested; the names come from the network
    std::size_t max_pixels = std::size_t{48} << 20U;  // all textures together
};

/// Reads a PNG or JPEG file, recognised by its first bytes. Safe for untrusted files: checks the
/// size before it decodes. Errors name the file: kNotFound, or kInvalidData if it is damaged or
/// exceeds `limits`. `read`, if not null, gets what was read, also of a file that fails.
Expected<renderer::TexturePicture> read_texture(const std::filesystem::path& file,
                                                const TextureLimits& limits = {},
                                                FilesRead* read = nullptr);

/// Loads the textures of one folder in the background: each once, and again when its file changes
/// while it differs from that of the world's server. The log names each failure and difference
/// once. Not thread-safe.
class TextureLibrary {
public:
    using Loaded = std::pair<std::string, renderer::TexturePicture>;

    explicit TextureLibrary(const std::filesystem::path& folder, const TextureLimits& limits = {});

    /// The version of a texture that the world's server has (FileVersions::expect).
    void expect(const std::string& file, const Fingerprint& of_server);
    /// Requests a file of the folder (bus::is_valid_model_file). Ignored if it was requested since
    /// the last `forget`.
    void want(const std::string& file);
    /// Whether the file could not be read.
    bool is_missing(const std::string& file) const { return missing_.contains(file); }
    /// Whether the texture is another version than that of the world's server.
    bool is_different(const std::string& file) const {
        return versions_.is_different(key_of(file));
    }
    /// Returns the textures loaded since the last call. Looks for changed files in the background.
    /// Never blocks.
    std::vector<Loaded> take(FileVersions::Clock::time_point now = FileVersions::Clock::now());
    /// Whether everything that was requested has been read and taken.
    bool is_idle() const { return reader_.is_idle(); }
    /// Drops all requests. Files may be requested again.
    void forget();

private:
    struct Request {
        std::string file;
        bool is_check = false;  // read it only if it has changed

        auto operator<=>(const Request&) const = default;
    };
    struct Read {
        std::optional<renderer::TexturePicture> picture;  // none: the file has not changed
        Fingerprint fingerprint;
    };
    static FileVersions::Key key_of(const std::string& file) { return {file, 1.0}; }
    void take(const Request& request, Expected<Read> read, std::vector<Loaded>& loaded);
    void complain(const std::string& file, const std::string& why, const std::string& advice);

    const std::filesystem::path folder_;
    TextureLimits limits_;
    std::map<std::string, std::size_t> num_pixels_;  // of the loaded textures
    std::size_t num_all_pixels_ = 0;
    std::set<std::string> missing_;
    std::set<std::string> complained_;
    FileVersions versions_;
    BackgroundReader<Request, Read> reader_;
};

}  // namespace atrium::viewer
