#include "tools/calibrate/recording/room_checks.hpp"

#include "site_node/capture/picture_file.hpp"
#include "site_node/capture/video_rotation.hpp"
#include "site_node/segmentation/component_votes.hpp"
#include "site_node/segmentation/room_light.hpp"
#include "site_node/segmentation/segmentation.hpp"
#include "site_node/segmentation/steady_picture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/videoio.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLearnFromPeople =
    "let the site learn it from the take: site_node --segmentation.background_from people "
    "(docs/backgrounds.md)";
constexpr std::size_t kMostPictures = 24;
constexpr std::size_t kFewestPictures = 8;  // in fewer, a person who walks hides the room too often
// Of the videos of all cameras together: 146 frames each of eight cameras of 1 MP. Two cores decode
// this in about 4 s.
constexpr std::size_t kMaxDecodedPixels = 1'200'000'000;

// Pictures spread over a video, or over `max_decoded` frames in its middle.
std::vector<image::YuvImage> read_video(const fs::path& file, std::size_t max_decoded) try {
    std::vector<image::YuvImage> pictures;
    cv::VideoCapture video(file.string(), cv::CAP_FFMPEG);
    if (!video.isOpened()) return pictures;
    const double count = video.get(cv::CAP_PROP_FRAME_COUNT);
    const bool is_known = std::isfinite(count) && count >= 1.0 && count < 1e9;
    const std::size_t num_frames = is_known ? static_cast<std::size_t>(count) : max_decoded;
    const std::size_t num_read = std::min(num_frames, max_decoded);
    // an inexact seek does no harm: any pictures will do
    if (num_read < num_frames)
        video.set(cv::CAP_PROP_POS_FRAMES, static_cast<double>((num_frames - num_read) / 2));
    cv::Mat bgr;
    for (std::size_t i = 0; i < num_read && video.grab(); ++i) {
        if (i * kMostPictures < pictures.size() * num_read) continue;
        if (!video.retrieve(bgr) || bgr.type() != CV_8UC3) break;
        capture::correct_rotation(video, bgr);
        image::yuv_from_bgr(bgr.data, bgr.cols, bgr.rows, bgr.step[0], pictures.emplace_back());
    }
    return pictures;
} catch (const cv::Exception&) {
    return {};
}

// Up to kMostPictures, of the size of the first one.
std::vector<image::YuvImage> read_some(const Shots& shots, std::size_t max_decoded) {
    std::vector<image::YuvImage> pictures;
    if (shots.is_video) {
        pictures = read_video(shots.path, max_decoded);
    } else {
        std::size_t i = 0;
        std::size_t num_tried = 0;
        for (const auto& [number, file] : shots.pictures) {
            if (i++ * kMostPictures < num_tried * shots.pictures.size()) continue;
            ++num_tried;
            if (!capture::PictureFile::of(file).read(0, pictures.emplace_back()))
                pictures.pop_back();
        }
    }
    if (pictures.empty()) return pictures;
    const int width = pictures[0].width();
    const int height = pictures[0].height();
    std::erase_if(pictures, [&](const image::YuvImage& picture) {
        return picture.width() != width || picture.height() != height;
    });
    return pictures;
}

// What a camera's pictures of the empty room and of the take say together.
struct RoomFinding {
    std::optional<segmentation::RoomGhost> ghost;
    std::optional<std::string> light;
    bool shows_nobody = false;  // no picture of the take differs from the room by a person
    // With `light`: what is compared, to find rooms that were exchanged.
    std::vector<std::uint16_t> room_luma;
    image::Plane take_luma;
};

bool shows_somebody(segmentation::Segmenter& segmenter, const image::YuvImage& picture) {
    image::Mask mask;
    if (!segmenter.segment(picture, mask)) return true;
    const auto num = std::ranges::count(mask.data, std::uint8_t{255});
    return segmentation::has_size_of_person(static_cast<std::int32_t>(num), mask);
}

RoomFinding compare_room(const Shots& frames, const Shots& room, std::size_t max_decoded) {
    const std::vector<image::YuvImage> take = read_some(frames, max_decoded);
    if (take.size() < kFewestPictures) return {};
    segmentation::BackgroundLearner learner;
    for (const image::YuvImage& picture : read_some(room, max_decoded))
        if (!learner.add(picture)) return {};
    const auto learned = learner.finish();
    if (!learned || learned->width != take[0].width() || learned->height != take[0].height())
        return {};
    const segmentation::SteadyPicture steady = segmentation::find_steady_picture(take);
    segmentation::LightScratch scratch;
    if (auto light = segmentation::doubt_of_light(learned->luma, steady.picture.y, scratch))
        return {std::nullopt, std::move(light), false, learned->luma, steady.picture.y};
    RoomFinding found{segmentation::find_ghost(*learned, steady, {}), std::nullopt, false, {}, {}};
    segmentation::Segmenter segmenter(*learned, {});
    found.shows_nobody = std::ranges::none_of(
        take, [&](const image::YuvImage& picture) { return shows_somebody(segmenter, picture); });
    return found;
}

fs::path shown_file(const Shots& shots) {
    return shots.pictures.size() == 1 ? shots.pictures.begin()->second : shots.path;
}

// A camera whose empty room fits badly.
struct BadRoom {
    std::string camera;
    RoomFinding finding;
};

bool fits(const BadRoom& room, const BadRoom& take) {
    segmentation::LightScratch scratch;
    const image::Plane& picture = take.finding.take_luma;
    return room.finding.room_luma.size() == picture.data.size() &&
           !segmentation::doubt_of_light(room.finding.room_luma, picture, scratch);
}

// "; those of 'a' and 'b' fit if they are exchanged, or if the videos of both are"
std::string exchanged(const std::vector<BadRoom>& rooms) {
    std::vector<std::string> pairs;
    for (std::size_t i = 0; i < rooms.size(); ++i)
        for (std::size_t k = i + 1; k < rooms.size(); ++k)
            if (fits(rooms[i], rooms[k]) && fits(rooms[k], rooms[i]))
                pairs.push_back(
                    fmt::format("those of '{}' and '{}'", rooms[i].camera, rooms[k].camera));
    return pairs.empty() ? std::string()
                         : fmt::format(
                               "; {} fit if they are exchanged: exchange these files, or "
                               "the videos of the take",
                               fmt::join(pairs, ", "));
}

}  // namespace

std::vector<RoomDoubt> doubt_rooms(const Material& material) {
    if (!material.masks.empty()) return {};
    std::vector<std::string> ghosts;
    std::vector<std::string> lights;
    std::vector<std::string> empty;
    std::vector<BadRoom> bad;
    for (const auto& [camera, room] : material.backgrounds) {
        const Look& look = material.looks.at(camera);
        const std::size_t pixels = static_cast<std::size_t>(look.width) *
                                   static_cast<std::size_t>(look.height) *
                                   material.backgrounds.size();
        RoomFinding found = compare_room(
            material.frames.at(camera),
            room,
            std::max(kMaxDecodedPixels / std::max<std::size_t>(pixels, 1), kMostPictures));
        const std::string file = shown_file(room).string();
        if (found.ghost) {
            ghosts.push_back(fmt::format(
                "'{}' at ({}, {}) of {}", camera, found.ghost->x, found.ghost->y, file));
        }
        if (found.shows_nobody) empty.push_back(fmt::format("'{}' ({})", camera, file));
        if (found.light) {
            lights.push_back(fmt::format("that of '{}' {} ({})", camera, *found.light, file));
            bad.push_back({camera, std::move(found)});
        }
    }
    std::vector<RoomDoubt> doubts;
    const auto is_most = [&](const std::vector<std::string>& places) {
        return 2 * places.size() > material.frames.size();
    };
    if (!ghosts.empty()) {
        doubts.push_back(
            {fmt::format("background: the empty room seems to show a person, or a thing that has "
                         "gone since: {}. People get holes and ghosts there. If these files show "
                         "nobody there, ignore this; else film the empty room again without "
                         "anybody, or {}",
                         fmt::join(ghosts, ", "),
                         kLearnFromPeople),
             is_most(ghosts)});
    }
    if (!lights.empty()) {
        const std::string exchange = exchanged(bad);
        doubts.push_back(
            {fmt::format("background: people cannot be told reliably from the empty room: {}{}. {} "
                         "it again with the cameras, the light and the exposure of the recording, "
                         "or {}",
                         fmt::join(lights, ", "),
                         exchange,
                         exchange.empty() ? "Film" : "Else film",
                         kLearnFromPeople),
             is_most(lights)});
    }
    if (!empty.empty()) {
        doubts.push_back(
            {fmt::format("background: nobody is seen before the empty room of {}, in up to {} "
                         "pictures of the take: does it show the same person? Film it without "
                         "anybody, or {}",
                         fmt::join(empty, ", "),
                         kMostPictures,
                         kLearnFromPeople),
             is_most(empty)});
    }
    return doubts;
}

}  // namespace atrium::calibrate
