#include "site_node/occupied_room/learn_occupied_room.hpp"

#include "site_node/occupied_room/contested_parts.hpp"
#include "site_node/occupied_room/never_empty.hpp"
#include "site_node/occupied_room/space_carver.hpp"
#include "site_node/segmentation/block_clusters.hpp"
#include "site_node/segmentation/component_votes.hpp"
#include "site_node/segmentation/segmentation.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace atrium::occupied_room {
namespace {

using segmentation::BackgroundStatistics;
using segmentation::BlockClusters;
using segmentation::BlockState;

constexpr int kRounds = 4;
constexpr std::size_t kMaxClusters = BlockClusters::kMaxClusters;
constexpr std::uint8_t kNone = BlockClusters::kNoCluster;

// How often each look of a block was seen in each situation.
struct Counts {
    std::array<std::uint16_t, kMaxClusters> empty{};   // as the room, and nobody is there
    std::array<std::uint16_t, kMaxClusters> ghost{};   // where somebody of the learned room stood
    std::array<std::uint16_t, kMaxClusters> person{};  // within a person
    std::array<std::uint16_t, kMaxClusters> alone{};   // within a person whom no other camera sees
    std::array<std::uint16_t, kMaxClusters> hidden{};  // as the room, but a person should be there
    std::array<std::uint16_t, kMaxClusters> needed{};  // as the room, which cuts a person off
};

// One camera while it learns.
class Camera {
public:
    Camera(std::span<const image::YuvView> pictures,
           const segmentation::SegmentationOptions& options)
        : options_(options) {
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            if (pictures[i].width() == 0) continue;
            pictures_.push_back(pictures[i]);
            instants_.push_back(i);
        }
        options_.drift_frames = 0.0;  // instants are far apart
        if (!has_enough()) return;
        clusters_ = segmentation::find_clusters(pictures_);
        chosen_ = decide_contested(pictures_, clusters_);
        unknown_.resize(clusters_.num_blocks());
        for (std::size_t b = 0; b < unknown_.size(); ++b) unknown_[b] = chosen_[b] == kNone ? 1 : 0;
        counts_.resize(clusters_.num_blocks());
    }

    /// Gives up places that somebody never left; see find_never_empty.
    void find_sitters(const SpaceCarver& carver, std::size_t camera) {
        never_empty_ =
            find_never_empty(clusters_,
                             chosen_,
                             make_room(),
                             carver.reachable(camera, clusters_.columns, clusters_.rows));
        for (std::size_t b = 0; b < unknown_.size(); ++b) unknown_[b] |= never_empty_[b];
    }

    bool has_enough() const { return pictures_.size() >= kMinOccupiedPictures; }
    std::size_t num_pictures() const { return pictures_.size(); }

    /// Segments all pictures with the current room; writes the masks of people per instant.
    void segment(std::vector<std::vector<image::Mask>>& people, std::size_t camera) {
        room_ = make_room();
        segmentation::Segmenter segmenter(room_, options_);
        states_.resize(pictures_.size());
        image::Mask mask;
        for (std::size_t i = 0; i < pictures_.size(); ++i) {
            // cannot fail: the room comes from pictures of this size
            if (!segmenter.segment(pictures_[i], mask)) continue;
            states_[i] = segmentation::judge_components(pictures_[i], room_, mask, scratch_);
            image::Mask& out = people[instants_[i]][camera];
            out = image::Mask(states_[i].width, states_[i].height);
            for (std::size_t b = 0; b < out.data.size(); ++b) {
                const auto state = static_cast<BlockState>(states_[i].data[b]);
                out.data[b] = state == BlockState::kPerson ? SpaceCarver::kPerson
                              : unknown_[b] != 0           ? SpaceCarver::kMayHide
                                                           : std::uint8_t{0};
            }
        }
    }

    /// Counts the looks at one instant.
    void count(std::size_t instant, const SpaceCarver::OthersSay& others) {
        const auto at = std::lower_bound(instants_.begin(), instants_.end(), instant);
        if (at == instants_.end() || *at != instant) return;
        const auto i = static_cast<std::size_t>(at - instants_.begin());
        for (std::size_t b = 0; b < counts_.size(); ++b) {
            const std::uint8_t label = clusters_.labels[i][b];
            if (label == kNone) continue;
            const auto state = static_cast<BlockState>(states_[i].data[b]);
            const bool is_hidden = others.hidden.data[b] != 0;
            Counts& counts = counts_[b];
            if (state == BlockState::kGhost) {
                ++counts.ghost[label];
            } else if (state == BlockState::kPerson) {
                ++(is_hidden ? counts.person : counts.alone)[label];
            } else if (others.needed.data[b] != 0) {
                ++counts.needed[label];
            } else {
                ++(is_hidden ? counts.hidden : counts.empty)[label];
            }
        }
    }

    /// Chooses the look of each block anew and forgets the counts.
    void choose() {
        for (std::size_t b = 0; b < counts_.size(); ++b) {
            choose(counts_[b], b);
            counts_[b] = {};
        }
    }

    LearnedRoom finish();

private:
    void choose(const Counts& counts, std::size_t block);
    BackgroundStatistics make_room() const {
        BackgroundStatistics room = statistics_of(pictures_, clusters_, chosen_);
        fill_unknown(unknown_, room);
        return room;
    }

    segmentation::SegmentationOptions options_;
    std::vector<image::YuvView> pictures_;
    std::vector<std::size_t> instants_;  // of the pictures
    BlockClusters clusters_;
    std::vector<std::uint8_t> chosen_;       // cluster per block
    std::vector<std::uint8_t> unknown_;      // per block: never seen empty
    std::vector<std::uint8_t> never_empty_;  // per block: somebody never left it
    std::vector<Counts> counts_;
    BackgroundStatistics room_;
    std::vector<image::Mask> states_;  // BlockState per picture and block
    segmentation::ComponentScratch scratch_;
};

void Camera::choose(const Counts& counts, std::size_t block) {
    if (never_empty_[block] != 0) return;
    const auto num = static_cast<double>(pictures_.size());
    const auto most = [](const auto& values) {
        return static_cast<std::uint8_t>(std::max_element(values.begin(), values.end()) -
                                         values.begin());
    };
    const std::uint8_t ghost = most(counts.ghost);
    const int seen_as_ghost = counts.ghost[ghost];
    const int seen_as_person = counts.person[ghost] + counts.alone[ghost];
    if (ghost != chosen_[block] && seen_as_ghost >= std::max(3.0, 0.03 * num) &&
        seen_as_ghost > 1.5 * seen_as_person) {
        chosen_[block] = ghost;
        unknown_[block] = 0;
        return;
    }
    // as this camera sees it, a person who is always there: such a look cuts off what others need
    std::array<std::uint16_t, kMaxClusters> seen_empty = counts.empty;
    const auto cuts_off = [&](std::uint8_t look) {
        return counts.needed[look] >= 3 && counts.needed[look] > 2 * counts.empty[look];
    };
    for (std::uint8_t look = 0; look < kMaxClusters; ++look)
        if (cuts_off(look)) seen_empty[look] = 0;
    const std::uint8_t empty = most(seen_empty);
    const double enough = std::max(2.0, 0.02 * num);
    if (seen_empty[empty] >= enough) {
        chosen_[block] = empty;
        unknown_[block] = 0;
        return;
    }
    const std::uint8_t alone = most(counts.alone);
    if (counts.alone[alone] >= std::max(3.0, 0.05 * num)) {
        chosen_[block] = alone;
        unknown_[block] = 0;
        return;
    }
    // other cameras often see too much, so their word alone does not make a lasting look a person
    const std::uint8_t hidden = most(counts.hidden);
    const bool lasts = hidden == chosen_[block] && counts.hidden[hidden] >= 0.5 * num;
    unknown_[block] = lasts && !cuts_off(hidden) ? 0 : 1;
}

LearnedRoom Camera::finish() {
    LearnedRoom learned;
    learned.room = make_room();
    learned.room.had_people = true;
    const auto num_unknown =
        static_cast<double>(std::count(unknown_.begin(), unknown_.end(), std::uint8_t{1}));
    learned.never_empty = num_unknown / static_cast<double>(unknown_.size());
    double covered = 0.0;
    for (const image::Mask& states : states_) {
        covered += static_cast<double>(std::count(states.data.begin(),
                                                  states.data.end(),
                                                  static_cast<std::uint8_t>(BlockState::kPerson)));
    }
    learned.covered = covered / static_cast<double>(states_.size() * unknown_.size());
    learned.never_empty_px =
        segmentation::largest_part(unknown_, clusters_.columns, clusters_.rows);
    return learned;
}

// Whether no camera has a picture at most instants: the files' numbers count on without pictures.
bool are_numbers_sparse(const OccupiedRoom& seen, std::size_t num_instants) {
    std::size_t num_empty = 0;
    for (std::size_t i = 0; i < num_instants; ++i) {
        const bool is_empty = std::ranges::all_of(seen.pictures, [&](const auto& views) {
            return i >= views.size() || views[i].width() == 0;
        });
        num_empty += is_empty ? 1 : 0;
    }
    return 2 * num_empty > num_instants;
}

tl::unexpected<Error> too_few_pictures(std::size_t num_pictures,
                                       std::size_t num_instants,
                                       bool is_sparse) {
    const std::string instants =
        is_sparse ? " of " + std::to_string(num_instants) + " instants have" : "";
    return make_error(
        ErrorKind::kNotFound,
        "only " + std::to_string(num_pictures) + instants +
            " pictures, but a room with people in it needs at least " +
            std::to_string(kMinOccupiedPictures) +
            (is_sparse ? ": number the pictures of the recording without gaps, as `calibrate "
                         "import` does, or record the empty room (background.*)"
                       : ": record for longer, or record the empty room (background.*)"));
}

}  // namespace

std::vector<Expected<LearnedRoom>> learn_occupied_room(
    const OccupiedRoom& seen,
    const segmentation::SegmentationOptions& options,
    const std::function<void(std::size_t, std::size_t)>& progress,
    std::stop_token stop) {
    std::vector<Camera> cameras;
    std::size_t num_instants = 0;
    std::size_t steps = 0;
    const auto step = [&](std::size_t num) {
        steps += num;
        progress(steps, (1 + 2 * kRounds) * seen.pictures.size());
    };
    for (const auto& pictures : seen.pictures) {
        num_instants = std::max(num_instants, pictures.size());
        cameras.emplace_back(pictures, options);
        step(1);
        if (stop.stop_requested()) break;
    }
    SpaceCarver carver(seen.cameras, seen.bounds_site);
    for (std::size_t c = 0; c < cameras.size() && !stop.stop_requested(); ++c)
        if (cameras[c].has_enough()) cameras[c].find_sitters(carver, c);
    for (int round = 0; round < kRounds && !stop.stop_requested(); ++round) {
        std::vector<std::vector<image::Mask>> people(num_instants,
                                                     std::vector<image::Mask>(cameras.size()));
        for (std::size_t c = 0; c < cameras.size() && !stop.stop_requested(); ++c) {
            if (cameras[c].has_enough()) cameras[c].segment(people, c);
            step(1);
        }
        std::vector<SpaceCarver::OthersSay> others_say;
        for (std::size_t i = 0; i < num_instants && !stop.stop_requested(); ++i) {
            carver.carve(people[i], others_say);
            for (std::size_t c = 0; c < cameras.size(); ++c)
                if (cameras[c].has_enough()) cameras[c].count(i, others_say[c]);
        }
        for (Camera& camera : cameras)
            if (camera.has_enough()) camera.choose();
        step(cameras.size());
    }
    std::vector<Expected<LearnedRoom>> learned;
    for (std::size_t c = 0; c < seen.cameras.size(); ++c) {
        if (stop.stop_requested()) {
            learned.push_back(make_error(ErrorKind::kUnavailable, "stopped while learning"));
        } else if (!cameras[c].has_enough()) {
            learned.push_back(too_few_pictures(
                cameras[c].num_pictures(), num_instants, are_numbers_sparse(seen, num_instants)));
        } else {
            learned.push_back(cameras[c].finish());
        }
    }
    return learned;
}

}  // namespace atrium::occupied_room
