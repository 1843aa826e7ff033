#include "site_node/capture/lost_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>

namespace atrium::capture {
namespace {

constexpr int kMaxDepth = 4;
constexpr std::size_t kMaxChunks = 20'000'000;  // ends the walk through a hostile file

// Walks the chunks of a RIFF file. Each has a name of four letters, its size, and its content.
class AviWalk {
public:
    explicit AviWalk(const std::filesystem::path& file) {
        stream_.rdbuf()->pubsetbuf(nullptr, 0);  // only the heads of chunks are read
        stream_.open(file, std::ios::binary | std::ios::ate);
        if (stream_) end_ = static_cast<std::uint64_t>(stream_.tellg());
    }

    LostPictures lost() {
        Chunk first;
        if (!read(0, first) || first.name() != "RIFF" || first.type() != "AVI ") return {};
        walk(0, end_, 0);
        // whole streams without bytes are damage of another kind
        return lost_.numbers.size() < lost_.num_pictures ? std::move(lost_) : LostPictures{};
    }

private:
    struct Chunk {
        std::array<char, 12> bytes{};
        std::string_view name() const { return {bytes.data(), 4}; }
        std::string_view type() const { return {bytes.data() + 8, 4}; }  // of a list
        std::uint64_t size() const {
            std::uint64_t value = 0;
            for (std::size_t i = 0; i < 4; ++i)
                value |= std::uint64_t{static_cast<unsigned char>(bytes[4 + i])} << (8 * i);
            return value;
        }
        bool is_list() const { return name() == "RIFF" || name() == "LIST"; }
    };

    bool read(std::uint64_t at, Chunk& chunk) {
        stream_.clear();
        stream_.seekg(static_cast<std::streamoff>(at));
        stream_.read(chunk.bytes.data(), chunk.bytes.size());
        return stream_.gcount() >= 8;
    }

    void walk(std::uint64_t at, std::uint64_t end, int depth) {
        while (at + 8 <= end && num_chunks_++ < kMaxChunks) {
            Chunk chunk;
            if (!read(at, chunk)) return;
            const std::uint64_t size = chunk.size();
            if (chunk.is_list()) {
                const std::string_view type = chunk.type();
                const bool holds_pictures =
                    type == "AVI " || type == "AVIX" || type == "movi" || type == "rec ";
                if (holds_pictures && depth < kMaxDepth)
                    walk(at + 12, std::min(end, at + 8 + size), depth + 1);
            } else {
                count(chunk);
            }
            at += 8 + size + size % 2;
        }
    }

    // "00dc" is a picture of stream 0. Those of the first stream with pictures count.
    void count(const Chunk& chunk) {
        const std::string_view name = chunk.name();
        if (!name.ends_with("dc") && !name.ends_with("db")) return;
        const std::array<char, 2> stream{name[0], name[1]};
        if (!pictures_of_) pictures_of_ = stream;
        if (*pictures_of_ != stream) return;
        if (chunk.size() == 0) lost_.numbers.push_back(lost_.num_pictures);
        ++lost_.num_pictures;
    }

    std::ifstream stream_;
    std::uint64_t end_ = 0;
    std::size_t num_chunks_ = 0;
    std::optional<std::array<char, 2>> pictures_of_;
    LostPictures lost_;
};

}  // namespace

LostPictures lost_pictures(const std::filesystem::path& avi) { return AviWalk(avi).lost(); }

std::string text_of_lost_pictures(const LostPictures& lost) {
    constexpr std::size_t kNamed = 4;
    const std::vector<std::size_t>& numbers = lost.numbers;
    if (numbers.empty()) return {};
    std::string ranges;
    std::size_t num_ranges = 0;
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t last = i;
        while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
        ranges += ranges.empty() ? "" : ", ";
        if (++num_ranges > kNamed) {
            ranges += "...";
            break;
        }
        ranges += last == i ? fmt::format("{}", numbers[i])
                            : fmt::format("{} to {}", numbers[i], numbers[last]);
        i = last + 1;
    }
    return fmt::format(
        "the camera lost {} of {} pictures ({}), as the file says; the site leaves these instants "
        "out",
        numbers.size(),
        lost.num_pictures,
        ranges);
}

}  // namespace atrium::capture
