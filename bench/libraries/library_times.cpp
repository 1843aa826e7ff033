// Times of pieces of Atrium beside those of libraries for the same work, on one thread. Writes
// comma-separated values, which libraries.sh keeps.

#include "bench/hull/hull_scenes.hpp"
#include "bench/median_ms.hpp"
#include "core/app/private_network.hpp"
#include "core/codec/mesh_codec.hpp"
#include "core/image/raw_image.hpp"
#include "site_node/silhouette/contours.hpp"
#include "tests/support/shapes/whole_mask.hpp"
#include "tests/support/virtual_display.hpp"
#include "tests/unit/silhouette/test_masks.hpp"

#include <dlfcn.h>
#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace atrium::bench {
namespace {

constexpr std::size_t kRepetitions = 51;
constexpr int kSmallest_px = 100;

void require(bool condition, std::string_view what) {
    if (condition) return;
    fmt::print(stderr, "failed: {}\n", what);
    std::exit(1);
}

// `bytes`: of the result, 0 if sizes do not matter
void print(std::string_view work, std::string_view by, double ms, std::size_t bytes = 0) {
    fmt::print("{},{},{:.3f},{}\n", work, by, ms, bytes == 0 ? "" : std::to_string(bytes));
    std::fflush(stdout);
}

void fill(const geometry::TriangleMesh& mesh, draco::Mesh& out) {
    const auto num_vertices = static_cast<std::uint32_t>(mesh.vertices.size());
    out.set_num_points(num_vertices);
    draco::GeometryAttribute layout;
    layout.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
    draco::PointAttribute& positions = *out.attribute(out.AddAttribute(layout, true, num_vertices));
    for (std::uint32_t i = 0; i < num_vertices; ++i) {
        const Eigen::Vector3f position = mesh.vertices[i].cast<float>();
        positions.SetAttributeValue(draco::AttributeValueIndex(i), position.data());
    }
    for (const auto& [a, b, c] : mesh.triangles)
        out.AddFace({draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
}

void measure_meshes() {
    const auto views = person_views(8, 280);
    hull::HullScratch scratch;
    const geometry::TriangleMesh mesh = hull::compute_visual_hull(views, {}, scratch).mesh;
    const codec::MeshCodecOptions options{.position_bits = 11};
    const std::string encode = fmt::format("encode a hull of {} triangles", mesh.triangles.size());

    codec::MeshEncoder encoder;
    std::vector<std::uint8_t> bytes;
    const double encode_ms = median_ms(
        kRepetitions, [&] { require(encoder.encode(mesh, options, bytes).has_value(), "encode"); });
    print(encode, "Atrium", encode_ms, bytes.size());
    draco::EncoderBuffer buffer;
    const auto with_draco = [&](int speed, bool standard) {
        return median_ms(kRepetitions, [&] {
            buffer.Clear();
            draco::Mesh in;
            fill(mesh, in);
            draco::Encoder draco;
            draco.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
            if (standard)
                draco.options().SetGlobalInt("edgebreaker_method",
                                             draco::MESH_EDGEBREAKER_STANDARD_ENCODING);
            draco.SetSpeedOptions(speed, speed);
            draco.SetAttributeQuantization(draco::GeometryAttribute::POSITION,
                                           options.position_bits);
            require(draco.EncodeMeshToBuffer(in, &buffer).ok(), "Draco's encoder");
        });
    };
    const double smallest_ms = with_draco(0, false);
    print(encode, "Draco at speed 0", smallest_ms, buffer.size());
    const double same_ms = with_draco(options.speed, true);
    print(encode, fmt::format("Draco at speed {}", options.speed), same_ms, buffer.size());
    require(std::equal(bytes.begin(),
                       bytes.end(),
                       buffer.data(),
                       buffer.data() + buffer.size(),
                       [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); }),
            "the same bytes as Draco");

    codec::MeshDecoder decoder;
    geometry::TriangleMesh decoded;
    print("decode that hull", "Atrium", median_ms(kRepetitions, [&] {
              require(decoder.decode(bytes, {}, decoded).has_value(), "decode");
          }));
    print("decode that hull", "Draco", median_ms(kRepetitions, [&] {
              draco::DecoderBuffer in;
              in.Init(buffer.data(), buffer.size());
              require(draco::Decoder().DecodeMeshFromBuffer(&in).ok(), "Draco's decoder");
          }));
}

cv::Mat mat_of(image::Mask& mask) { return {mask.height, mask.width, CV_8U, mask.data.data()}; }

// Turns over the parts of `value` that are too small.
void remove_parts_opencv(cv::Mat& mask, std::uint8_t value, int connectivity, int least_px) {
    cv::Mat labels, stats, centroids;
    const cv::Mat parts = value == 255 ? mask : ~mask;
    cv::connectedComponentsWithStats(parts, labels, stats, centroids, connectivity, CV_32S);
    std::vector<std::uint8_t> is_small(static_cast<std::size_t>(stats.rows));
    for (int i = 1; i < stats.rows; ++i)
        is_small[static_cast<std::size_t>(i)] = stats.at<int>(i, cv::CC_STAT_AREA) < least_px;
    for (int y = 0; y < mask.rows; ++y) {
        const int* const label = labels.ptr<int>(y);
        std::uint8_t* const row = mask.ptr(y);
        for (int x = 0; x < mask.cols; ++x)
            if (is_small[static_cast<std::size_t>(label[x])] != 0)
                row[x] = static_cast<std::uint8_t>(255 - value);
    }
}

void measure_masks() {
    std::mt19937 random(1);
    image::Mask raw = silhouette::test::person_mask();
    silhouette::test::roughen(raw, 0.1, random);

    segmentation::CleanScratch scratch;
    image::Mask smooth;
    const std::string_view majority = "majority of 3x3 in a mask of 1 MP";
    print(majority, "Atrium", median_ms(kRepetitions, [&] {
              segmentation::test::majority_3x3(raw, scratch, smooth);
          }));
    cv::Mat median;
    print(majority, "OpenCV medianBlur", median_ms(kRepetitions, [&] {
              cv::medianBlur(mat_of(raw), median, 3);
          }));
    require(cv::countNonZero(median != mat_of(smooth)) == 0, "the same majority");

    const std::string_view parts = "remove small parts of a mask of 1 MP";
    image::Mask ours = smooth;
    print(parts, "Atrium", median_ms(kRepetitions, [&] {
              segmentation::test::remove_small_parts(ours, kSmallest_px, kSmallest_px, scratch);
          }));
    cv::Mat theirs = mat_of(smooth).clone();
    print(parts, "OpenCV connectedComponentsWithStats", median_ms(kRepetitions, [&] {
              remove_parts_opencv(theirs, 0, 8, kSmallest_px);
              remove_parts_opencv(theirs, 255, 4, kSmallest_px);
          }));
    require(cv::countNonZero(theirs != mat_of(ours)) == 0, "the same parts");

    const std::string_view contours = "contours of a mask of 1 MP";
    silhouette::ContourSet set;
    print(contours, "Atrium", median_ms(kRepetitions, [&] {
              silhouette::trace_contours(ours, 1, set);
          }));
    std::vector<std::vector<cv::Point>> found;
    print(contours, "OpenCV findContours", median_ms(kRepetitions, [&] {
              cv::findContours(theirs, found, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
          }));
}

using Libyuv = int (*)(
    const std::uint8_t*, int, std::uint8_t*, int, std::uint8_t*, int, std::uint8_t*, int, int, int);

// Debian splits libyuv's headers from the library that others depend on: called by name.
void measure_libyuv(std::string_view work,
                    const char* function,
                    const image::RawImage& raw,
                    image::YuvImage& out) {
    void* const library = dlopen("libyuv.so.0", RTLD_NOW);
    if (library == nullptr) {
        fmt::print(stderr, "left out, as it is not there: libyuv.so.0\n");
        return;
    }
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): dlsym
    const auto convert = reinterpret_cast<Libyuv>(dlsym(library, function));
    require(convert != nullptr, function);
    print(work, fmt::format("libyuv {}", function), median_ms(kRepetitions, [&] {
              convert(raw.planes[0].data,
                      static_cast<int>(raw.planes[0].stride_bytes),
                      out.y.data.data(),
                      out.y.width,
                      out.u.data.data(),
                      out.u.width,
                      out.v.data.data(),
                      out.v.width,
                      raw.width,
                      raw.height);
          }));
    dlclose(library);
}

void measure_colours() {
    std::vector<std::uint8_t> bytes(3000 * 1000);
    std::mt19937 random(3);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    image::RawImage raw;
    raw.width = raw.height = 1000;
    image::YuvImage buffer;
    const auto convert = [&](std::string_view work, image::PixelFormat format) {
        raw.format = format;
        raw.planes[0] = {bytes.data(), image::row_bytes(format, raw.width)};
        print(work, "Atrium", median_ms(kRepetitions, [&] { image::working_view(raw, buffer); }));
    };
    const std::string_view bgr = "BGR of 1 MP to Y'CbCr 4:2:0";
    convert(bgr, image::PixelFormat::kBgr);
    cv::Mat planes;
    print(bgr, "OpenCV cvtColor", median_ms(kRepetitions, [&] {
              cv::cvtColor(
                  cv::Mat(1000, 1000, CV_8UC3, bytes.data()), planes, cv::COLOR_BGR2YUV_I420);
          }));
    measure_libyuv(bgr, "RGB24ToJ420", raw, buffer);
    const std::string_view uyvy = "UYVY of 1 MP to Y'CbCr 4:2:0";
    convert(uyvy, image::PixelFormat::kUyvy);
    measure_libyuv(uyvy, "UYVYToI420", raw, buffer);
    const std::string_view bayer = "Bayer mosaic of 1 MP to Y'CbCr 4:2:0";
    convert(bayer, image::PixelFormat::kBayerRG);
    cv::Mat colours;
    print(bayer, "OpenCV cvtColor twice", median_ms(kRepetitions, [&] {
              cv::cvtColor(
                  cv::Mat(1000, 1000, CV_8U, bytes.data()), colours, cv::COLOR_BayerBG2BGR);
              cv::cvtColor(colours, planes, cv::COLOR_BGR2YUV_I420);
          }));
}

bool runs(const char* command) { return std::system(command) == 0; }

// Ends with its network; the parent stays where it is.
bool enters_private_network() {
    const pid_t child = fork();
    if (child == 0) _exit(app::enter_private_network() && app::bring_up_loopback(1) ? 0 : 1);
    int status = 0;
    return waitpid(child, &status, 0) == child && status == 0;
}

void measure_programs() {
    const std::string_view display = "start and stop a display without a screen";
    print(display, "Atrium", median_ms(5, [&] {
              require(test_support::VirtualDisplay::start(640, 480).has_value(), display);
          }));
    print(display, "xvfb-run", median_ms(5, [&] {
              require(runs("xvfb-run -a -s '-screen 0 640x480x24' true"), display);
          }));
    const std::string_view network = "enter a private network";
    print(network, "Atrium", median_ms(kRepetitions, [&] {
              require(enters_private_network(), network);
          }));
    print(network, "unshare and ip", median_ms(kRepetitions, [&] {
              require(runs("unshare --map-root-user --net ip link set lo up"), network);
          }));
}

}  // namespace
}  // namespace atrium::bench

int main() {
    cv::setNumThreads(1);
    fmt::print("work,by,ms,bytes\n");
    atrium::bench::measure_meshes();
    atrium::bench::measure_masks();
    atrium::bench::measure_colours();
    atrium::bench::measure_programs();
}
