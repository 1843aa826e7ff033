#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace atrium::capture {

/// Pictures that a camera lost. In AVI files, programs that record keep the time by chunks without
/// bytes, which mean that the picture before is shown once more. Decoders leave them out, so that
/// the pictures behind them would come too early.
struct LostPictures {
    std::vector<std::size_t> numbers;  // ascending
    std::size_t num_pictures = 0;      // with the lost ones

    bool has(std::size_t number) const { return std::ranges::binary_search(numbers, number); }
    /// How many pictures of the file are before that one. `number` is not lost.
    std::size_t num_before(std::size_t number) const {
        const auto after = std::ranges::lower_bound(numbers, number);
        return number - static_cast<std::size_t>(after - numbers.begin());
    }
    /// The number after the last of so many pictures of the file.
    std::size_t end_of(std::size_t num_in_file) const {
        for (const std::size_t lost : numbers) num_in_file += lost < num_in_file ? 1 : 0;
        return num_in_file;
    }
};

/// Finds them in an AVI file; none in other files, and in those that cannot be read. Reads the
/// headers of the chunks only. The bytes may be hostile.
LostPictures lost_pictures(const std::filesystem::path& avi);

/// "the camera lost 4 of 60 pictures (10 to 12, 40); ..."; empty if it lost none.
std::string text_of_lost_pictures(const LostPictures& lost);

}  // namespace atrium::capture
