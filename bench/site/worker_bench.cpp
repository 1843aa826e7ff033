// What a segmentation worker costs a site: pictures of one camera of 1 MP (1000 x 1000), so ms per
// run are ms per megapixel. `ask` needs a worker at the socket that the variable ATRIUM_WORKER
// names:
//   python3 tools/segmentation_worker/opencv_worker.py /tmp/worker &
//   ATRIUM_WORKER=/tmp/worker build/bin/worker_bench --benchmark_repetitions=5
//   --benchmark_report_aggregates_only=true

#include "core/image/raw_image.hpp"
#include "site_node/segmentation_worker/worker_client.hpp"
#include "tests/unit/silhouette/test_masks.hpp"

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include <cstdlib>
#include <random>

namespace atrium {
namespace {

using segmentation_worker::BgrPicture;
using segmentation_worker::WorkerClient;
using segmentation_worker::WorkerTally;

constexpr int kSize = 1000;
constexpr std::size_t kPixels = std::size_t{kSize} * kSize;

// A grey room with noise; darker in the foreground of `mask`.
image::YuvImage picture_of(const image::Mask& mask, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0.0F, 2.0F);
    image::YuvImage picture{image::Plane(kSize, kSize),
                            image::Plane(kSize / 2, kSize / 2, 120),
                            image::Plane(kSize / 2, kSize / 2, 135)};
    for (std::size_t i = 0; i < kPixels; ++i)
        picture.y.data[i] =
            static_cast<std::uint8_t>((mask.data[i] != 0 ? 60.0F : 140.0F) + noise(random));
    return picture;
}

segmentation::BackgroundModel learned_room() {
    segmentation::BackgroundLearner learner;
    if (!learner.add(picture_of(image::Mask(kSize, kSize), 1))) std::abort();
    return learner.finish(segmentation::SegmentationOptions{}).value();
}

void write_bgr(benchmark::State& state) {
    std::vector<std::uint8_t> bytes(3 * kPixels);
    std::mt19937 random(3);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    image::RawImage raw;
    raw.format = static_cast<image::PixelFormat>(state.range(0));
    raw.width = raw.height = kSize;
    raw.planes[0] = {bytes.data(), image::row_bytes(raw.format, kSize)};
    raw.planes[1] = raw.planes[2] = {bytes.data(), kSize / 2};
    image::YuvImage buffer;
    const image::YuvView working = image::working_view(raw, buffer);
    std::vector<std::uint8_t> out(3 * kPixels);
    BgrPicture bgr;
    for (auto _ : state) bgr.write(raw, working, {}, out.data());
}
BENCHMARK(write_bgr)
    ->ArgName("format")
    ->Arg(static_cast<int>(image::PixelFormat::kYuv420))
    ->Arg(static_cast<int>(image::PixelFormat::kBayerRG))
    ->Arg(static_cast<int>(image::PixelFormat::kBgr))
    ->Unit(benchmark::kMillisecond);

void write_background(benchmark::State& state) {
    const segmentation::BackgroundModel model = learned_room();
    std::vector<std::uint8_t> out(3 * kPixels);
    BgrPicture bgr;
    for (auto _ : state) bgr.write(model, {}, out.data());
}
BENCHMARK(write_background)->Unit(benchmark::kMillisecond);

void mask_of_alpha(benchmark::State& state) {
    const image::Mask alpha = silhouette::test::person_mask();
    image::SparseMask out;
    out.mask = image::Mask(kSize, kSize);
    segmentation::CleanScratch scratch;
    for (auto _ : state)
        segmentation_worker::mask_of_alpha(alpha.data.data(), {}, {}, {}, scratch, out);
}
BENCHMARK(mask_of_alpha)->Unit(benchmark::kMillisecond);

// From a picture to its mask by a real worker.
void ask(benchmark::State& state) {
    const char* const socket = std::getenv("ATRIUM_WORKER");
    if (socket == nullptr) return state.SkipWithError("ATRIUM_WORKER names no socket");
    const auto tally = std::make_shared<WorkerTally>(10'000.0);
    auto client = WorkerClient::create(
        {socket, 10'000.0, std::chrono::seconds(1)}, {"bench", kSize, kSize, {}}, {}, tally);
    if (!client) std::abort();
    segmentation_worker::connect_at_start({client->get()}, std::chrono::seconds(10), {});
    const segmentation::BackgroundModel model = learned_room();
    const auto picture =
        std::make_shared<image::YuvImage>(picture_of(silhouette::test::person_mask(), 2));
    image::SparseMask out;
    out.mask = image::Mask(kSize, kSize);
    out.forget();
    for (auto _ : state) {
        if (!(*client)->wants_picture()) return state.SkipWithError("no worker is there");
        (*client)->offer(image::RawImage(picture), *picture, {}, model, {});
        if (!(*client)->take({}, out)) return state.SkipWithError("the worker has no answer");
        (*client)->keep_last(out.mask);
    }
}
BENCHMARK(ask)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace atrium

int main(int argc, char** argv) {
    cv::setNumThreads(1);
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
