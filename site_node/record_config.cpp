#include "site_node/record_config.hpp"

#include <algorithm>
#include <cstdint>
#include <thread>

namespace atrium::site_node {
namespace {

constexpr std::uint64_t kMegabyte = 1'000'000;
constexpr int kMaxRecordThreads = 16;

// Bytes of two pixels, as far as the configuration tells.
std::size_t bytes_of_two_pixels(const CaptureConfig& capture) {
    if (capture.source != "cameras") return 3;  // 4:2:0
    const std::string& format = capture.cameras.options.common.pixel_format;
    if (format.starts_with("RGB") || format.starts_with("BGR")) return 6;
    return format.find("422") != std::string::npos ? 4 : 2;
}

capture::RawCodec codec_of(const std::string& name) {
    for (const capture::RawCodec codec : {capture::RawCodec::kRaw, capture::RawCodec::kFfv1}) {
        if (name == capture::name_of(codec)) return codec;
    }
    // halves the bytes in a tenth of the time of FFV1: bench/record/raw_codecs.sh
    return capture::RawCodec::kHuffYuv;
}

// Writing alone fills no core; FFV1 fills all.
int default_threads(capture::RawCodec codec) {
    const int num_cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    if (codec == capture::RawCodec::kRaw) return 1;
    const int num_wanted = codec == capture::RawCodec::kFfv1 ? num_cores : 2;
    return std::clamp(num_wanted, 1, kMaxRecordThreads);
}

}  // namespace

void declare(RecordConfig& config, config::OptionSet& set) {
    set.add("record.folder",
            config.folder,
            "record what the cameras deliver into this folder, which must be new or empty");
    set.add_alias("record");
    set.add("record.orders",
            config.orders,
            "let `atrium record --site` of this world start recordings, as new folders in this "
            "folder; empty: nobody may");
    set.add("record.codec",
            config.codec,
            "all are lossless; auto: huffyuv, half the bytes for little work; raw: as the cameras "
            "deliver; ffv1: the smallest, needs half a core per camera of 1 MP at 30 Hz",
            {"auto", "raw", "huffyuv", "ffv1"});
    set.add("record.queue_s",
            config.queue_s,
            "pictures that wait in memory for the disk [s]; in a full queue new ones are dropped "
            "and counted",
            {0.1, 60});
    set.add("record.pre_roll_s",
            config.pre_roll_s,
            "pictures kept in memory while nothing is recorded: a recording begins with them [s]",
            {0, 600});
    set.add("record.memory_mb",
            config.memory_mb,
            "limit for the memory of queue and pre-roll [MB]",
            {16, 1e6});
    set.add("record.min_free_mb",
            config.min_free_mb,
            "the recording ends before its disk has less free space [MB]",
            {0, 1e9});
    set.add("record.threads",
            config.threads,
            "threads that compress and write; 0: 1 for raw, 2 for huffyuv, all cores for ffv1",
            {0, kMaxRecordThreads});
}

record::RecorderOptions recorder_options(const RecordConfig& config,
                                         const CaptureConfig& capture,
                                         const config::Rig& rig,
                                         double rate_hz) {
    record::RecorderOptions options;
    options.codec = codec_of(config.codec);
    options.rate_hz = rate_hz;
    for (const auto& camera : rig.cameras) {
        const auto num_pixels = static_cast<std::size_t>(camera.intrinsics.width) *
                                static_cast<std::size_t>(camera.intrinsics.height);
        options.bytes_per_instant += num_pixels * bytes_of_two_pixels(capture) / 2;
    }
    options.queue_s = config.queue_s;
    options.pre_roll_s = config.pre_roll_s;
    options.memory_bytes = static_cast<std::uint64_t>(config.memory_mb) * kMegabyte;
    options.min_free_bytes = static_cast<std::uint64_t>(config.min_free_mb) * kMegabyte;
    options.num_threads = config.threads > 0 ? config.threads : default_threads(options.codec);
    return options;
}

}  // namespace atrium::site_node
