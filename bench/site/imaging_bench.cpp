// Stages between picture and hull, each on one camera of 1 MP (1000 x 1000). ms per run are
// therefore ms per megapixel. Run with --benchmark_repetitions=5
// --benchmark_report_aggregates_only=true and quote the minimum or the median.

#include "core/codec/texture_codec.hpp"
#include "core/image/raw_image.hpp"
#include "site_node/segmentation/segmentation.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "site_node/texture/texture.hpp"
#include "tests/support/pictures/bgr_from_yuv.hpp"
#include "tests/support/shapes/bounding_rect.hpp"
#include "tests/support/shapes/whole_mask.hpp"
#include "tests/unit/silhouette/test_masks.hpp"

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <random>

namespace atrium {
namespace {

void require(const Expected<void>& result) {
    if (!result) std::abort();
}

image::Mask rough_person() {
    std::mt19937 random(1);
    image::Mask mask = silhouette::test::person_mask();
    silhouette::test::roughen(mask, 0.1, random);
    return mask;
}

// A grey room with noise, and other pixels in the foreground of `mask`.
image::YuvImage frame_with(const image::Mask& mask, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 2.0);
    const auto byte = [&](double v) {
        return static_cast<std::uint8_t>(std::clamp(v + noise(random), 0.0, 255.0));
    };
    image::YuvImage frame{image::Plane(1000, 1000), image::Plane(500, 500), image::Plane(500, 500)};
    for (int y = 0; y < 1000; ++y) {
        for (int x = 0; x < 1000; ++x) {
            const bool person = mask.at(x, y) != 0;
            const double texture = 30.0 * std::sin(0.15 * x) * std::sin(0.11 * y);
            frame.y.row(y)[x] = byte(person ? 90.0 + texture : 120.0 + 0.08 * x);
            if ((x | y) % 2 != 0) continue;
            frame.u.row(y / 2)[x / 2] = byte(person ? 150.0 : 120.0);
            frame.v.row(y / 2)[x / 2] = byte(person ? 100.0 : 118.0);
        }
    }
    return frame;
}

segmentation::BackgroundModel learned_room() {
    segmentation::BackgroundLearner learner;
    for (unsigned i = 0; i < 5; ++i) require(learner.add(frame_with(image::Mask(1000, 1000), i)));
    return learner.finish({}).value();
}

geometry::PinholeCamera camera(bool distorted) {
    geometry::PinholeCamera result{
        .width = 1000, .height = 1000, .fx = 900, .fy = 900, .cx = 500, .cy = 500};
    if (distorted) result.distortion = {-0.28, 0.08, 0.0005, -0.0003, 0.0};
    return result;
}

void pixel_test(benchmark::State& state) {
    const auto model = learned_room();
    const image::YuvImage frame = frame_with(rough_person(), 9);
    image::Mask out(1000, 1000);
    const auto instructions = static_cast<segmentation::InstructionSet>(state.range(0));
    const auto gain = static_cast<std::int16_t>(segmentation::kUnitGain * 100 / state.range(1));
    for (auto _ : state)
        segmentation::test::test_rows(frame, model, gain, instructions, {0, 1000}, out.data.data());
}
BENCHMARK(pixel_test)
    ->ArgNames({"avx2", "light_percent"})
    ->ArgsProduct({{0, 1}, {100, 110}})
    ->Unit(benchmark::kMillisecond);

void majority(benchmark::State& state) {
    const image::Mask raw = rough_person();
    segmentation::CleanScratch scratch;
    image::Mask out(1000, 1000);
    for (auto _ : state) segmentation::test::majority_3x3(raw, scratch, out);
}
BENCHMARK(majority)->Unit(benchmark::kMillisecond);

void remove_small_parts(benchmark::State& state) {
    const image::Mask raw = rough_person();
    segmentation::CleanScratch scratch;
    image::Mask cleaned;
    segmentation::test::majority_3x3(raw, scratch, cleaned);
    // only the first run removes parts, all runs search for them
    for (auto _ : state) segmentation::test::remove_small_parts(cleaned, 100, 100, scratch);
}
BENCHMARK(remove_small_parts)->Unit(benchmark::kMillisecond);

// From the sensor's bytes to the input of segmentation.
void convert(benchmark::State& state) {
    std::vector<std::uint8_t> bytes(3000 * 1000);
    std::mt19937 random(3);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    image::RawImage raw;
    raw.format = static_cast<image::PixelFormat>(state.range(0));
    raw.width = raw.height = 1000;
    raw.planes[0] = {bytes.data(), image::row_bytes(raw.format, raw.width)};
    image::YuvImage buffer;
    for (auto _ : state) benchmark::DoNotOptimize(image::working_view(raw, buffer));
}
BENCHMARK(convert)
    ->ArgName("format")
    ->Arg(static_cast<int>(image::PixelFormat::kBayerRG))
    ->Arg(static_cast<int>(image::PixelFormat::kBgr))
    ->Arg(static_cast<int>(image::PixelFormat::kUyvy))
    ->Unit(benchmark::kMillisecond);

void segment(benchmark::State& state) {
    segmentation::Segmenter segmenter(learned_room().room, {});
    const image::YuvImage frame = frame_with(rough_person(), 9);
    image::Mask out;
    for (auto _ : state) require(segmenter.segment(frame, out));
}
BENCHMARK(segment)->Unit(benchmark::kMillisecond);

// From the sensor's bytes to the cleaned mask.
void raw_to_mask(benchmark::State& state) {
    image::RawImage raw;
    raw.format = static_cast<image::PixelFormat>(state.range(0));
    raw.width = raw.height = 1000;
    const auto pictures = [&](const image::Mask& mask) {
        std::vector<std::uint8_t> bgr = test::bgr_from_yuv(frame_with(mask, 9));
        if (raw.format == image::PixelFormat::kBgr) return bgr;
        std::vector<std::uint8_t> bayer(1000 * 1000);
        for (std::size_t i = 0; i < bayer.size(); ++i) {
            const std::size_t x = i % 1000, y = i / 1000;
            bayer[i] = bgr[3 * i + (y % 2 == 0 ? (x % 2 == 0 ? 2 : 1) : (x % 2 == 0 ? 1 : 0))];
        }
        return bayer;
    };
    image::YuvImage buffer;
    const auto view = [&](const std::vector<std::uint8_t>& bytes) {
        raw.planes[0] = {bytes.data(), image::row_bytes(raw.format, raw.width)};
        return image::working_view(raw, buffer);
    };
    segmentation::BackgroundLearner learner;
    require(learner.add(view(pictures(image::Mask(1000, 1000)))));
    segmentation::Segmenter segmenter(learner.finish().value(), {});
    const std::vector<std::uint8_t> bytes = pictures(rough_person());
    raw.planes[0].data = bytes.data();
    image::SparseMask out;
    for (auto _ : state) {
        image::WorkingPicture picture(raw, buffer);
        require(segmenter.segment(picture, out));
    }
}
BENCHMARK(raw_to_mask)
    ->ArgName("format")
    ->Arg(static_cast<int>(image::PixelFormat::kBayerRG))
    ->Arg(static_cast<int>(image::PixelFormat::kBgr))
    ->Unit(benchmark::kMillisecond);

void extract_silhouette(benchmark::State& state) {
    const image::Mask mask = rough_person();
    const geometry::PinholeCamera intrinsics = camera(state.range(0) != 0);
    silhouette::SilhouetteScratch scratch;
    std::vector<silhouette::SilhouettePolygon> out;
    for (auto _ : state) silhouette::extract_silhouette(mask, intrinsics, {}, scratch, out);
    std::size_t vertices = 0;
    for (const auto& polygon : out) vertices += polygon.vertices_px.size();
    state.counters["vertices"] = static_cast<double>(vertices);
}
BENCHMARK(extract_silhouette)->ArgName("distorted")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

// A worst case that no camera delivers: noise everywhere, and parallel threads across the whole
// picture.
void extract_worst_silhouette(benchmark::State& state) {
    image::Mask mask = silhouette::test::noise_mask(1000, 1000, 0.6, 1);
    if (state.range(0) != 0) {
        for (int y = 0; y < 1000; ++y) {
            for (int x = 0; x < 1000; ++x) mask.row(y)[x] = y == 0 || x % 2 == 0 ? 255 : 0;
        }
    }
    const geometry::PinholeCamera intrinsics = camera(false);
    silhouette::SilhouetteScratch scratch;
    std::vector<silhouette::SilhouettePolygon> out;
    for (auto _ : state) silhouette::extract_silhouette(mask, intrinsics, {}, scratch, out);
}
BENCHMARK(extract_worst_silhouette)
    ->ArgName("threads")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);

void crop_texture(benchmark::State& state) {
    const image::Mask mask = rough_person();
    const image::YuvImage frame = frame_with(mask, 9);
    texture::TextureScratch scratch;
    codec::TextureCrop crop;
    const image::PixelRect subject = test::bounding_rect(mask);
    for (auto _ : state)
        benchmark::DoNotOptimize(texture::crop_texture(frame, mask, subject, {}, scratch, crop));
}
BENCHMARK(crop_texture)->Unit(benchmark::kMillisecond);

codec::TextureCrop person_crop() {
    const image::Mask mask = rough_person();
    texture::TextureScratch scratch;
    codec::TextureCrop crop;
    const image::PixelRect subject = test::bounding_rect(mask);
    if (!texture::crop_texture(frame_with(mask, 9), mask, subject, {}, scratch, crop)) std::abort();
    return crop;
}

void encode_texture(benchmark::State& state) {
    const codec::TextureCrop crop = person_crop();
    codec::TextureEncoder encoder;
    codec::CodedTexture out;
    for (auto _ : state) require(encoder.encode(crop, 85, out));
    state.counters["colour_bytes"] = static_cast<double>(out.colour.size());
    state.counters["mask_bytes"] = static_cast<double>(out.mask.size());
}
BENCHMARK(encode_texture)->Unit(benchmark::kMillisecond);

void decode_texture(benchmark::State& state) {
    codec::CodedTexture coded;
    require(codec::TextureEncoder().encode(person_crop(), 85, coded));
    codec::TextureDecoder decoder;
    codec::DecodedTexture out;
    for (auto _ : state) require(decoder.decode(coded.colour, coded.mask, out));
}
BENCHMARK(decode_texture)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace atrium

BENCHMARK_MAIN();
