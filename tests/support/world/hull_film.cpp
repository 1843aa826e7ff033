#include "tests/support/world/hull_film.hpp"

#include "core/codec/mesh_codec.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "tests/support/world/camera_masks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <optional>

namespace atrium::test {
namespace {

namespace fs = std::filesystem;

class Studio {
public:
    explicit Studio(const FilmOptions& options) : options_(options), random_(options.seed) {
        for (const auto& camera : options.cameras) {
            painters_.emplace_back(camera);
            views_.push_back({camera.intrinsics, camera.camera_from_site, {}, {}});
        }
    }

    Expected<std::vector<std::uint8_t>> take(const geometry::TriangleMesh& mesh_site) {
        for (std::size_t i = 0; i < painters_.size(); ++i) {
            MaskPainter& painter = painters_[i];
            painter.clear();
            painter.draw(mesh_site);
            painter.flicker(options_.flicker, random_);
            silhouette::extract_silhouette(
                painter.mask(), views_[i].intrinsics, {}, silhouette_scratch_, polygons_);
            views_[i].contours.clear();
            for (const auto& polygon : polygons_) views_[i].contours.push_back(polygon.vertices_px);
        }
        const hull::VisualHull hull = hull::compute_visual_hull(views_, {}, hull_scratch_);
        std::vector<std::uint8_t> bytes;
        if (hull.status == hull::HullStatus::kEmptyIntersection) return bytes;
        if (hull.status != hull::HullStatus::kOk)
            return make_error(ErrorKind::kInvalidData, hull::to_string(hull.status));
        const int bits = codec::position_bits_for(hull.mesh, options_.cameras);
        if (auto coded = codec::MeshEncoder().encode(hull.mesh, {.position_bits = bits}, bytes);
            !coded)
            return tl::unexpected(coded.error());
        return bytes;
    }

private:
    const FilmOptions& options_;
    Random random_;
    std::vector<MaskPainter> painters_;
    std::vector<hull::SilhouetteView> views_;
    silhouette::SilhouetteScratch silhouette_scratch_;
    std::vector<silhouette::SilhouettePolygon> polygons_;
    hull::HullScratch hull_scratch_;
};

template <typename T>
void put(std::ostream& out, const T& value) {
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

template <typename T>
T get(std::istream& in) {
    T value{};
    in.read(reinterpret_cast<char*>(&value), sizeof value);
    return value;
}

constexpr std::uint64_t kMaxBytes = 10'000'000;  // of one mesh

std::optional<HullFilm> read(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) return std::nullopt;
    HullFilm film;
    const auto num_frames = get<std::uint64_t>(in);
    for (std::uint64_t i = 0; i < num_frames && in; ++i) {
        HullFilm::Frame frame;
        frame.capture_s = get<double>(in);
        const auto size = get<std::uint64_t>(in);
        if (!in || size > kMaxBytes) return std::nullopt;
        frame.draco.resize(size);
        in.read(reinterpret_cast<char*>(frame.draco.data()), static_cast<std::streamsize>(size));
        film.frames.push_back(std::move(frame));
    }
    if (!in) return std::nullopt;
    return film;
}

Expected<void> write(const fs::path& file, const HullFilm& film) {
    std::error_code failed;
    fs::create_directories(file.parent_path(), failed);
    const fs::path part = file.string() + ".part";
    {
        std::ofstream out(part, std::ios::binary);
        put(out, std::uint64_t{film.frames.size()});
        for (const auto& frame : film.frames) {
            put(out, frame.capture_s);
            put(out, std::uint64_t{frame.draco.size()});
            out.write(reinterpret_cast<const char*>(frame.draco.data()),
                      static_cast<std::streamsize>(frame.draco.size()));
        }
        if (!out.flush())
            return make_error(ErrorKind::kUnavailable, "cannot write " + part.string());
    }
    fs::rename(part, file, failed);
    if (failed) return make_error(ErrorKind::kUnavailable, "cannot write " + file.string());
    return {};
}

}  // namespace

Expected<HullFilm> film(const Act& act, const FilmOptions& options, const fs::path& cache) {
    const fs::path file = cache / fmt::format("{}_{}cams_{}px_{:g}hz_{:.4f}s_{}_{:g}_v{}.hulls",
                                              act.name,
                                              options.cameras.size(),
                                              options.cameras.front().intrinsics.width,
                                              options.rate_hz,
                                              options.first_s,
                                              options.seed,
                                              options.flicker,
                                              kFilmVersion);
    if (!cache.empty()) {
        if (auto kept = read(file)) return std::move(*kept);
    }
    const ActedPerson person(act);
    Studio studio(options);
    HullFilm film;
    for (int i = 0;; ++i) {
        const double time_s = options.first_s + i / options.rate_hz;
        if (time_s > act.seconds) break;
        auto bytes = studio.take(person.mesh_site(time_s));
        if (!bytes) {
            return make_error(
                bytes.error().kind,
                fmt::format("{} at {:.3f} s: {}", act.name, time_s, bytes.error().message));
        }
        film.frames.push_back({time_s, std::move(*bytes)});
    }
    if (!cache.empty()) {
        if (auto written = write(file, film); !written) return tl::unexpected(written.error());
    }
    return film;
}

}  // namespace atrium::test
