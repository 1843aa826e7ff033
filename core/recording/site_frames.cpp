#include "core/recording/site_frames.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace atrium::recording {
namespace {

constexpr std::size_t kTexturesPerCamera = 8;  // as the bus keeps
// Textures are written before their mesh, at most so much.
constexpr std::chrono::seconds kTexturesBefore{1};

}  // namespace

SiteFrames::SiteFrames(std::shared_ptr<const WorldFile> world,
                       std::string site,
                       Timestamp begin,
                       Timestamp end)
    : world_(std::move(world)), site_(std::move(site)), begin_(begin), end_(end), cursor_(world_) {
    cursor_.seek_to(begin + -kTexturesBefore);
}

Expected<SiteFrames> SiteFrames::open(std::shared_ptr<const WorldFile> world,
                                      const std::string& site,
                                      Timestamp begin,
                                      Timestamp end) {
    if (!std::ranges::binary_search(world->sites(), site)) {
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{}: it has no site '{}'; it has {}",
                                      world->file().path().string(),
                                      site,
                                      world->sites().empty()
                                          ? "none"
                                          : fmt::format("{}", fmt::join(world->sites(), ", "))));
    }
    return SiteFrames(std::move(world), site, begin, end);
}

void SiteFrames::keep_until(Timestamp time) {
    const auto& kept = world_->kept();
    for (; next_kept_ < kept.size() && kept[next_kept_].sample.time <= time; ++next_kept_) {
        const WorldFile::Kept& one = kept[next_kept_];
        if (one.key != site_ || one.sample.raw.kind != bus::RawKind::kSample) continue;
        if (one.sample.topic->name() == "SiteDescription") {
            if (auto read = bus::from_raw<bus::SiteDescription>(one.sample.raw))
                description_ = std::make_shared<const bus::SiteDescription>(std::move(*read));
        } else if (one.sample.topic->name() == "SitePlacement") {
            if (auto read = bus::from_raw<bus::SitePlacement>(one.sample.raw))
                placement_ = std::move(*read);
        }
    }
}

std::optional<SiteFrame> SiteFrames::complete(const PlayedSample& sample) {
    auto mesh = bus::from_raw<bus::SiteMesh>(sample.raw);
    if (!mesh) {
        ++num_refused_;
        return std::nullopt;
    }
    if (mesh->site != site_ || description_ == nullptr) return std::nullopt;
    SiteFrame frame;
    frame.time = sample.time;
    frame.description = description_;
    frame.placement = placement_;
    for (std::size_t i = 0; i < mesh->textured_cameras.size(); ++i) {
        const bus::FrameKey key = bus::texture_frame(*mesh, i);
        const auto& of_camera = textures_[mesh->textured_cameras[i]];
        const auto found = std::ranges::find_if(of_camera, [&](const bus::CameraTexture& one) {
            return one.frame_id == key.frame_id && one.capture_time == key.capture_time;
        });
        if (found != of_camera.end()) frame.textures.push_back(*found);
    }
    if (frame.textures.size() < mesh->textured_cameras.size()) ++num_incomplete_;
    frame.mesh = std::move(*mesh);
    return frame;
}

std::optional<SiteFrame> SiteFrames::next() {
    for (const PlayedSample* sample = cursor_.peek(); sample != nullptr && sample->time <= end_;
         sample = cursor_.peek()) {
        std::optional<SiteFrame> frame;
        keep_until(sample->time);
        if (sample->raw.kind == bus::RawKind::kSample) {
            if (sample->topic->name() == "CameraTexture") {
                auto texture = bus::from_raw<bus::CameraTexture>(sample->raw);
                if (!texture) {
                    ++num_refused_;
                } else if (texture->site == site_) {
                    auto& of_camera = textures_[texture->camera];
                    of_camera.push_back(std::move(*texture));
                    if (of_camera.size() > kTexturesPerCamera) of_camera.pop_front();
                }
            } else if (sample->topic->name() == "SiteMesh" && sample->time >= begin_) {
                frame = complete(*sample);
            }
        }
        cursor_.pop();
        if (frame) return frame;
    }
    return std::nullopt;
}

}  // namespace atrium::recording
