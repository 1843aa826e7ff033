#include "site_node/occupied_room/contested_parts.hpp"

#include "site_node/segmentation/outline_votes.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <numeric>

namespace atrium::occupied_room {
namespace {

using segmentation::BlockClusters;
using segmentation::BlockValue;
using segmentation::OutlineVote;

// One bit per picture; further pictures do not take part in the comparison.
constexpr std::size_t kMaxPictures = 256;
using Times = std::array<std::uint64_t, kMaxPictures / 64>;

int num_in(const Times& times) {
    int num = 0;
    for (const std::uint64_t word : times) num += std::popcount(word);
    return num;
}

template <typename Combine>
int num_of(const Times& a, const Times& b, Combine&& combine) {
    int num = 0;
    for (std::size_t i = 0; i < a.size(); ++i) num += std::popcount(combine(a[i], b[i]));
    return num;
}

int num_both(const Times& a, const Times& b) { return num_of(a, b, std::bit_and<>()); }
int num_either(const Times& a, const Times& b) { return num_of(a, b, std::bit_or<>()); }

// The two most frequent looks of a block.
struct Looks {
    std::array<Times, 2> times{};
    std::array<int, 2> num{};
    std::array<BlockValue, 2> value{};
};

// Whether two blocks change their looks together. `is_crossed`: the first look of one is the second
// of the other.
struct Tie {
    bool holds = false;
    bool is_crossed = false;
};

Tie tie_of(const Looks& a, const Looks& b) {
    // shares of the pictures with either look
    constexpr double kSameTimes = 0.7;
    constexpr double kSameTimesAlone = 0.96;
    const auto share = [&](std::size_t i, std::size_t j) {
        return static_cast<double>(num_both(a.times[i], b.times[j])) /
               std::max(num_either(a.times[i], b.times[j]), 1);
    };
    // without a second look, which passers-by may hide, the first has to agree the better
    if (a.num[1] == 0 || b.num[1] == 0) return {share(0, 0) >= kSameTimesAlone, false};
    const double straight = std::min(share(0, 0), share(1, 1));
    const double crossed = std::min(share(0, 1), share(1, 0));
    return {std::max(straight, crossed) >= kSameTimes, crossed > straight};
}

// Union-find whose members are equal or opposite to their root.
class ParityForest {
public:
    explicit ParityForest(std::size_t size) : parent_(size), is_opposite_(size, 0) {
        std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
    }

    std::uint32_t root_of(std::uint32_t member, std::uint8_t& is_opposite) {
        std::uint32_t root = member;
        std::uint8_t sum = 0;
        while (parent_[root] != root) {
            sum ^= is_opposite_[root];
            root = parent_[root];
        }
        is_opposite = sum;
        while (parent_[member] != root && member != root) {
            const std::uint32_t next = parent_[member];
            const std::uint8_t own = is_opposite_[member];
            parent_[member] = root;
            is_opposite_[member] = sum;
            sum ^= own;
            member = next;
        }
        return root;
    }

    void join(std::uint32_t a, std::uint32_t b, bool is_crossed) {
        std::uint8_t opposite_a = 0;
        std::uint8_t opposite_b = 0;
        const std::uint32_t root_a = root_of(a, opposite_a);
        const std::uint32_t root_b = root_of(b, opposite_b);
        if (root_a == root_b) return;  // a contradiction is ignored
        parent_[root_b] = root_a;
        is_opposite_[root_b] =
            static_cast<std::uint8_t>(opposite_a ^ opposite_b ^ (is_crossed ? 1 : 0));
    }

private:
    std::vector<std::uint32_t> parent_;
    std::vector<std::uint8_t> is_opposite_;
};

// A part of the picture whose blocks change looks together. Hypothesis 0 or 1: the look of the
// room is the root's first or second.
struct Part {
    std::vector<std::uint32_t> blocks;
    std::array<double, 2> num{};   // pictures that show the look of either hypothesis
    std::size_t num_with_two = 0;  // blocks with a second look
    bool is_decided = false;
    std::uint8_t room = 0;
};

int contrast(const BlockValue& a, const BlockValue& b) {
    int luma = 0;
    for (std::size_t i = 0; i < 4; ++i) luma += std::abs(a[i] - b[i]);
    return luma / 4 + std::abs(a[4] - b[4]) + std::abs(a[5] - b[5]);
}

class ContestedParts {
public:
    ContestedParts(std::span<const image::YuvView> pictures, const BlockClusters& clusters)
        : columns_(clusters.columns),
          rows_(clusters.rows),
          num_pictures_(std::min(pictures.size(), kMaxPictures)) {
        collect(pictures, clusters);
        join();
    }

    std::vector<std::uint8_t> decide() {
        // from the parts whose surroundings are known to those inside
        for (bool is_changed = true; is_changed;) {
            is_changed = false;
            for (Part& part : parts_)
                if (!part.is_decided && decide(part)) is_changed = true;
        }
        std::vector<std::uint8_t> room(looks_.size(), 0);
        for (std::size_t b = 0; b < room.size(); ++b) {
            const std::uint8_t look = room_look(b);
            room[b] = looks_[b].num[look] > 0 ? look : BlockClusters::kNoCluster;
        }
        return room;
    }

private:
    static constexpr std::uint32_t kNoPart = 0xffffffff;
    static constexpr double kLeastShare = 0.08;  // of the pictures, to be a lasting look

    void collect(std::span<const image::YuvView> pictures, const BlockClusters& clusters);
    void join();
    bool decide(Part& part);

    bool is_contested(std::size_t block) const {
        return looks_[block].num[0] <= (1.0 - kLeastShare) * static_cast<double>(num_pictures_);
    }
    bool is_known(std::size_t block) const {
        return part_of_[block] == kNoPart || parts_[part_of_[block]].is_decided;
    }
    std::uint8_t room_look(std::size_t block) const {
        if (part_of_[block] == kNoPart) return 0;
        const Part& part = parts_[part_of_[block]];
        if (!part.is_decided) return 0;
        return part.room ^ is_opposite_[block];
    }

    int columns_;
    int rows_;
    std::size_t num_pictures_;
    std::vector<Looks> looks_;               // per block
    std::vector<std::uint32_t> part_of_;     // per block
    std::vector<std::uint8_t> is_opposite_;  // per block
    std::vector<Part> parts_;
};

void ContestedParts::collect(std::span<const image::YuvView> pictures,
                             const BlockClusters& clusters) {
    looks_.resize(clusters.num_blocks());
    for (std::size_t block = 0; block < looks_.size(); ++block) {
        Looks& looks = looks_[block];
        std::array<std::array<int, 6>, 2> sums{};
        const int column = static_cast<int>(block) % columns_;
        const int row = static_cast<int>(block) / columns_;
        for (std::size_t i = 0; i < num_pictures_; ++i) {
            const std::uint8_t label = clusters.labels[i][block];
            if (label > 1) continue;
            looks.times[label][i / 64] |= std::uint64_t{1} << (i % 64);
            const BlockValue value = segmentation::block_value(pictures[i], column, row);
            for (std::size_t k = 0; k < value.size(); ++k) sums[label][k] += value[k];
        }
        for (std::size_t l = 0; l < 2; ++l) {
            looks.num[l] = num_in(looks.times[l]);
            for (std::size_t k = 0; k < sums[l].size(); ++k)
                looks.value[l][k] =
                    static_cast<std::uint8_t>(sums[l][k] / std::max(looks.num[l], 1));
        }
        if (looks.num[1] < std::max(3.0, kLeastShare * static_cast<double>(num_pictures_))) {
            looks.num[1] = 0;
            looks.times[1] = {};
        }
    }
}

void ContestedParts::join() {
    ParityForest forest(looks_.size());
    for (int row = 0; row < rows_; ++row) {
        for (int column = 0; column < columns_; ++column) {
            const auto here = static_cast<std::uint32_t>(row * columns_ + column);
            if (!is_contested(here)) continue;
            const auto try_join = [&](std::uint32_t there) {
                if (!is_contested(there)) return;
                const Tie tie = tie_of(looks_[here], looks_[there]);
                if (tie.holds) forest.join(here, there, tie.is_crossed);
            };
            if (column > 0) try_join(here - 1);
            if (row > 0) try_join(here - static_cast<std::uint32_t>(columns_));
        }
    }
    part_of_.assign(looks_.size(), kNoPart);
    is_opposite_.assign(looks_.size(), 0);
    std::vector<std::uint32_t> part_of_root(looks_.size(), kNoPart);
    for (std::uint32_t block = 0; block < looks_.size(); ++block) {
        if (!is_contested(block)) continue;
        std::uint8_t is_opposite = 0;
        std::uint32_t& part = part_of_root[forest.root_of(block, is_opposite)];
        if (part == kNoPart) {
            part = static_cast<std::uint32_t>(parts_.size());
            parts_.emplace_back();
        }
        part_of_[block] = part;
        is_opposite_[block] = is_opposite;
        parts_[part].blocks.push_back(block);
        for (const std::size_t l : {std::size_t{0}, std::size_t{1}})
            parts_[part].num[l ^ is_opposite] += looks_[block].num[l];
        if (looks_[block].num[1] > 0) ++parts_[part].num_with_two;
    }
    // a place that people only pass has no lasting second look
    constexpr double kFew = 0.3;
    for (Part& part : parts_)
        part.is_decided = part.num_with_two < kFew * static_cast<double>(part.blocks.size());
}

bool ContestedParts::decide(Part& part) {
    const std::uint32_t own = part_of_[part.blocks.front()];
    const auto is_own = [&](int column, int row) {
        return column >= 0 && row >= 0 && column < columns_ && row < rows_ &&
               part_of_[static_cast<std::size_t>(row * columns_ + column)] == own;
    };
    struct Step {
        int x, y;
    };
    std::array<int, 2> votes{};  // for the hypothesis that the look is a person
    int num_outline = 0;
    int num_known = 0;
    for (const std::uint32_t block : part.blocks) {
        const int column = static_cast<int>(block) % columns_;
        const int row = static_cast<int>(block) / columns_;
        for (const Step d : {Step{1, 0}, Step{-1, 0}, Step{0, 1}, Step{0, -1}}) {
            if (is_own(column + d.x, row + d.y)) continue;
            // two blocks beyond: the outline itself is blurred
            const int out_x = column + 2 * d.x;
            const int out_y = row + 2 * d.y;
            if (out_x < 0 || out_y < 0 || out_x >= columns_ || out_y >= rows_) continue;
            if (is_own(out_x, out_y)) continue;
            ++num_outline;
            const auto out = static_cast<std::size_t>(out_y * columns_ + out_x);
            if (!is_known(out)) continue;
            ++num_known;
            const bool has_inner = is_own(column - d.x, row - d.y);
            const std::uint32_t inner =
                has_inner ? static_cast<std::uint32_t>((row - d.y) * columns_ + column - d.x)
                          : block;
            // passers-by hid one of the looks
            if (looks_[inner].num[1] == 0 || looks_[out].num[room_look(out)] == 0) continue;
            const BlockValue& beyond = looks_[out].value[room_look(out)];
            const auto of = [&](std::size_t hypothesis) {
                return contrast(looks_[inner].value[hypothesis ^ is_opposite_[inner]], beyond);
            };
            const OutlineVote vote = segmentation::compare_contrasts(of(0), of(1));
            votes[0] += vote == OutlineVote::kPicture ? 1 : 0;
            votes[1] += vote == OutlineVote::kRoom ? 1 : 0;
        }
    }
    const int fewest_votes = std::clamp(num_outline / 3, 2, 6);
    if (3 * num_known < num_outline || votes[0] + votes[1] < fewest_votes) return false;
    // the more frequent look is the room's unless the outline is clear
    const std::uint8_t frequent = part.num[1] > part.num[0] ? 1 : 0;
    const double share =
        static_cast<double>(votes[frequent]) / static_cast<double>(votes[0] + votes[1]);
    const double ratio = part.num[frequent] / std::max(part.num[1 - frequent], 1.0);
    const double needed = std::min(0.55 + 0.02 * ratio, 0.9);
    part.is_decided = true;
    part.room = static_cast<std::uint8_t>(share > needed ? 1 - frequent : frequent);
    return true;
}

}  // namespace

std::vector<std::uint8_t> decide_contested(std::span<const image::YuvView> pictures,
                                           const BlockClusters& clusters) {
    return ContestedParts(pictures, clusters).decide();
}

}  // namespace atrium::occupied_room
