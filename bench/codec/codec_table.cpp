// Coded size of one frame, its error inside the silhouettes, and the time on one thread, for
// several texture qualities. Writes comma-separated values, which codec_table.sh keeps.

#include "bench/codec/codec_frames.hpp"
#include "bench/median_ms.hpp"
#include "bench/value_of.hpp"
#include "core/codec/mesh_codec.hpp"
#include "site_node/texture/texture.hpp"
#include "tests/support/pictures/texture_error.hpp"
#include "tests/support/shapes/decode_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace atrium::bench {
namespace {

constexpr std::size_t kRepetitions = 25;
constexpr int kQualities[] = {50, 60, 70, 75, 80, 82, 84, 85, 86, 87, 88, 90, 92, 95};

/// Over all frames of a scene: sums, and the worst camera.
struct Row {
    double triangles = 0.0;
    double position_bits = 0.0;
    double subject_px = 0.0;
    double mesh_kb = 0.0;
    double masks_kb = 0.0;
    double colours_kb = 0.0;
    test::TextureError error;
    // of Y, Cb and Cr, by camera
    double worst_db = std::numeric_limits<double>::infinity();
    double sum_db = 0.0;
    int num_views = 0;
    double crop_ms = 0.0;
    double encode_mesh_ms = 0.0;
    double encode_textures_ms = 0.0;
    double decode_mesh_ms = 0.0;
    double decode_textures_ms = 0.0;
};

void measure_mesh(const CodecFrame& frame, Row& row) {
    codec::MeshEncoder encoder;
    std::vector<std::uint8_t> bytes;
    std::vector<geometry::CalibratedCamera> cameras;
    for (const CodecView& view : frame.views) cameras.push_back(view.camera);
    row.encode_mesh_ms += median_ms(kRepetitions, [&] {
        const int bits = codec::position_bits_for(frame.mesh, cameras);
        value_of(encoder.encode(frame.mesh, {.position_bits = bits}, bytes));
    });
    row.position_bits += codec::position_bits_for(frame.mesh, cameras);
    row.decode_mesh_ms += median_ms(kRepetitions, [&] { value_of(test::decode_mesh(bytes)); });
    row.triangles += static_cast<double>(frame.mesh.triangles.size());
    row.mesh_kb += 1e-3 * static_cast<double>(bytes.size());
}

void measure_textures(const CodecFrame& frame, int quality, Row& row) {
    codec::TextureEncoder encoder;
    codec::TextureDecoder decoder;
    std::vector<codec::CodedTexture> coded(frame.views.size());
    std::vector<codec::DecodedTexture> shown(frame.views.size());
    texture::TextureScratch scratch;
    codec::TextureCrop crop;
    row.crop_ms += median_ms(kRepetitions, [&] {
        for (const CodecView& view : frame.views) {
            if (!texture::crop_texture(
                    view.picture, view.mask, view.crop.crop_px, {.padding_px = 0}, scratch, crop))
                std::abort();
        }
    });
    row.encode_textures_ms += median_ms(kRepetitions, [&] {
        for (std::size_t i = 0; i < coded.size(); ++i)
            require(encoder.encode(frame.views[i].crop, quality, coded[i]));
    });
    row.decode_textures_ms += median_ms(kRepetitions, [&] {
        for (std::size_t i = 0; i < coded.size(); ++i)
            require(decoder.decode(coded[i].colour, coded[i].mask, shown[i]));
    });
    for (std::size_t i = 0; i < coded.size(); ++i) {
        row.masks_kb += 1e-3 * static_cast<double>(coded[i].mask.size());
        row.colours_kb += 1e-3 * static_cast<double>(coded[i].colour.size());
        const test::TextureError error = test::texture_error(frame.views[i].crop, shown[i]);
        row.error.add(error);
        row.subject_px += static_cast<double>(error.luma.num_samples());
        row.worst_db = std::min(row.worst_db, error.ycbcr().psnr_db());
        row.sum_db += error.ycbcr().psnr_db();
        ++row.num_views;
    }
}

void print(const std::vector<CodecFrame>& frames, int quality, const Row& row) {
    const auto num_frames = static_cast<double>(frames.size());
    fmt::print("{},{},{:.0f},{:.0f},{:.1f},{:.0f}",
               frames.front().scene,
               quality,
               row.num_views / num_frames,
               row.triangles / num_frames,
               row.position_bits / num_frames,
               row.subject_px / num_frames);
    const double kb = row.mesh_kb + row.masks_kb + row.colours_kb;
    for (const double size : {row.mesh_kb, row.masks_kb, row.colours_kb, kb})
        fmt::print(",{:.2f}", size / num_frames);
    for (const double db : {row.sum_db / row.num_views,
                            row.worst_db,
                            row.error.luma.psnr_db(),
                            row.error.chroma.psnr_db(),
                            row.error.rgb.psnr_db()})
        fmt::print(",{:.2f}", db);
    for (const double ms : {row.crop_ms,
                            row.encode_mesh_ms,
                            row.encode_textures_ms,
                            row.encode_mesh_ms + row.encode_textures_ms,
                            row.decode_mesh_ms,
                            row.decode_textures_ms,
                            row.decode_mesh_ms + row.decode_textures_ms})
        fmt::print(",{:.2f}", ms / num_frames);
    fmt::print("\n");
    std::fflush(stdout);
}

void measure(const std::vector<CodecFrame>& frames) {
    Row meshes;
    for (const CodecFrame& frame : frames) measure_mesh(frame, meshes);
    for (const int quality : kQualities) {
        Row row = meshes;
        for (const CodecFrame& frame : frames) measure_textures(frame, quality, row);
        print(frames, quality, row);
    }
}

int run() {
    fmt::print(
        "scene,quality,views,triangles,position_bits,subject_px,mesh_kb,masks_kb,colours_kb,total_"
        "kb,psnr_db,"
        "worst_psnr_db,luma_psnr_db,chroma_psnr_db,rgb_psnr_db,crop_ms,encode_mesh_ms,encode_"
        "textures_ms,"
        "encode_ms,decode_mesh_ms,decode_textures_ms,decode_ms\n");
    measure(value_of(simulated_frames(3)));
    const std::filesystem::path ring = ATRIUM_SOURCE_DIR "/../shared/data/recordings/ring20";
    if (!std::filesystem::exists(ring)) {
        fmt::print(stderr, "left out, as it is not there: {}\n", ring.string());
        return 0;
    }
    measure(value_of(recorded_frames(ring, 8)));
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main() { return atrium::bench::run(); }
