#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace atrium::capture {

inline constexpr const char* kTruncatedText = "the file is truncated; copy or export it again";

/// True if an AVI, MP4, MOV or MKV file ends before its container does, as after an interrupted
/// copy. Reads only a few bytes. False for other files, and for those that cannot be read. The
/// bytes may be hostile.
bool is_truncated_video(const std::filesystem::path& file);

/// Pictures that decoders deliver of a video with so many in its header: fewer if an MP4 or MOV
/// file was trimmed without encoding. Its edit list then leaves out pictures that are in the file.
/// Reads the header only. The bytes may be hostile.
std::size_t num_shown_pictures(const std::filesystem::path& file, std::size_t in_header);

/// Whole pictures of a video whose header announces `in_header`: fewer if the file is truncated,
/// which is then read, but not decoded.
std::size_t num_whole_pictures(const std::filesystem::path& file, std::size_t in_header);

/// "the video ends after picture 40 of 100: ...", with the cure.
std::string text_of_truncated_video(std::size_t num_whole, std::size_t in_header);

}  // namespace atrium::capture
