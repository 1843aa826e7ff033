#include "viewer/playback/thumbnails.hpp"

#include "core/base/named_thread.hpp"
#include "core/base/thread_priority.hpp"
#include "core/bus/messages.hpp"
#include "core/codec/texture_codec.hpp"
#include "core/recording/moment.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr std::uint8_t kGround = 172;  // the grey of a usual scene

// The texture of each site that shows most of its person.
std::map<std::string, bus::CameraTexture> largest_textures(
    const std::vector<recording::KeyedSample>& samples) {
    std::map<std::string, bus::CameraTexture> largest;
    const auto size = [](const bus::CameraTexture& texture) {
        return std::int64_t{texture.crop_px.width} * texture.crop_px.height;
    };
    for (const recording::KeyedSample& one : samples) {
        if (one.sample.topic->name() != "CameraTexture") continue;
        auto texture = bus::from_raw<bus::CameraTexture>(one.sample.raw);
        if (!texture) continue;
        const auto found = largest.find(texture->site);
        if (found == largest.end() || size(*texture) > size(found->second))
            largest.insert_or_assign(texture->site, std::move(*texture));
    }
    return largest;
}

// Scales the picture into columns [left, left + width), in its own shape, over the ground.
void put(const codec::DecodedTexture& picture, int left, int width, Thumbnail& out) {
    const double scale = std::min(static_cast<double>(width) / picture.width,
                                  static_cast<double>(Thumbnail::kHeight) / picture.height);
    const int w = std::max(1, static_cast<int>(scale * picture.width));
    const int h = std::max(1, static_cast<int>(scale * picture.height));
    const int x0 = left + (width - w) / 2;
    const int y0 = Thumbnail::kHeight - h;
    for (int y = 0; y < h; ++y) {
        const int from_y = std::min(picture.height - 1, static_cast<int>((y + 0.5) / scale));
        for (int x = 0; x < w; ++x) {
            const int from_x = std::min(picture.width - 1, static_cast<int>((x + 0.5) / scale));
            const auto from = 4 * (static_cast<std::size_t>(from_y) * picture.width + from_x);
            if (picture.rgba[from + 3] == 0) continue;
            const auto to = 4 * (static_cast<std::size_t>(y0 + y) * Thumbnail::kWidth + x0 + x);
            std::copy_n(picture.rgba.begin() + static_cast<std::ptrdiff_t>(from),
                        3,
                        out.rgba.begin() + static_cast<std::ptrdiff_t>(to));
        }
    }
}

}  // namespace

Thumbnail make_thumbnail(const std::shared_ptr<const recording::WorldFile>& world, Timestamp time) {
    Thumbnail out;
    out.rgba.assign(std::size_t{4} * Thumbnail::kWidth * Thumbnail::kHeight, kGround);
    for (std::size_t i = 3; i < out.rgba.size(); i += 4) out.rgba[i] = 255;
    const auto textures = largest_textures(recording::moment(world, time));
    codec::TextureDecoder decoder;
    int number = 0;
    for (const auto& [site, texture] : textures) {
        const int left = number * Thumbnail::kWidth / static_cast<int>(textures.size());
        const int right = (++number) * Thumbnail::kWidth / static_cast<int>(textures.size());
        codec::DecodedTexture picture;
        if (decoder.decode(texture.colour, texture.mask, picture) && picture.width > 0)
            put(picture, left, std::max(1, right - left), out);
    }
    return out;
}

Thumbnails::Thumbnails(std::shared_ptr<const recording::WorldFile> world)
    : world_(std::move(world)), made_(kNum) {
    thread_ = named_thread("thumbnails", [this](const std::stop_token& stop) { make(stop); });
}

void Thumbnails::make(const std::stop_token& stop) {
    lower_thread_priority();
    for (std::size_t i = 0; i < kNum && !stop.stop_requested(); ++i) {
        const auto share = (static_cast<double>(i) + 0.5) / static_cast<double>(kNum);
        const auto time =
            static_cast<std::int64_t>(share * static_cast<double>(world_->duration().count()));
        Thumbnail made = make_thumbnail(world_, world_->begin() + std::chrono::nanoseconds(time));
        const std::lock_guard lock(mutex_);
        made_[i] = std::move(made);
        ++revision_;
    }
}

std::vector<Thumbnail> Thumbnails::all() const {
    const std::lock_guard lock(mutex_);
    return made_;
}

std::size_t Thumbnails::revision() const {
    const std::lock_guard lock(mutex_);
    return revision_;
}

}  // namespace atrium::viewer
