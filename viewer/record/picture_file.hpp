#pragma once

#include "core/base/expected.hpp"
#include "viewer/renderer/rendered_picture.hpp"

#include <filesystem>

namespace atrium::viewer {

/// Creates the file's folder if missing and checks that the file can be written, so a wrong path is
/// reported before any picture is drawn. Error kUnavailable.
Expected<void> prepare_file(const std::filesystem::path& file);

/// Writes a PNG through a temporary file, so readers never see half a picture. Error kUnavailable.
Expected<void> write_png(const std::filesystem::path& file,
                         const renderer::RenderedPicture& picture);

}  // namespace atrium::viewer
