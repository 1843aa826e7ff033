#include "viewer/renderer/person/outline_strip.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

namespace atrium::renderer {
namespace {

constexpr float kStripAngleFloor = 0.06F;  // [rad] keeps the weight of an aligned camera finite
constexpr float kNoAngle = 40.0F;          // [rad]
constexpr float kLeastStripWeight = 0.02F;
constexpr float kMostWidth_m = 0.05F;
constexpr float kLeastSeen = 0.5F;  // as outline_strip_fragment
constexpr std::size_t kFloats = floats_per_vertex(kStripCameras);

using Weights = std::array<float, kStripCameras>;

// Maps directions to differences of layer coordinates. The lens distortion bends a few texels too
// little to matter.
Eigen::Matrix3f layer_from_site(const PersonModel::Camera& camera) {
    const geometry::PinholeCamera& lens = camera.intrinsics;
    Eigen::Matrix3d px_from_camera;
    px_from_camera << lens.fx, lens.skew, lens.cx, 0.0, lens.fy, lens.cy, 0.0, 0.0, 1.0;
    const image::PixelRect& crop = camera.crop_px;
    const Eigen::Array2d st_per_px = (camera.high_st - camera.low_st).cast<double>().array() /
                                     Eigen::Array2d(crop.width, crop.height);
    const Eigen::Array2d crop_origin(crop.x - 0.5, crop.y - 0.5);
    Eigen::Matrix3d layer_from_px = Eigen::Matrix3d::Identity();
    layer_from_px.diagonal().head<2>() = st_per_px;
    layer_from_px.col(2).head<2>() = camera.low_st.cast<double>().array() - crop_origin * st_per_px;
    return (layer_from_px * px_from_camera * camera.camera_from_site.rotation.toRotationMatrix())
        .cast<float>();
}

// One of the cameras of a strip.
struct StripCamera {
    std::size_t index = 0;  // in the model
    float weight = 0.0F;    // the sum of all is 1
    Eigen::Vector3f centre_site = Eigen::Vector3f::Zero();
    Eigen::Matrix3f layer_from_site = Eigen::Matrix3f::Zero();  // of directions
    const Eigen::Vector3f* coordinates = nullptr;               // per vertex: PersonModel
    const std::uint8_t* layer = nullptr;
};
using StripCameras = std::array<StripCamera, kStripCameras>;

// Those nearest to the eye's direction, with the weights of `choose_cameras` as if all saw
// everything well.
StripCameras cameras_for(const PersonModel& model, const Eigen::Vector3f& eye_site) {
    const Eigen::Vector3f middle = model.bounds_site.center();
    const Eigen::Vector3f to_eye = (eye_site - middle).normalized();
    std::array<std::pair<float, std::size_t>, kStripCameras + 1> nearest;
    nearest.fill({kNoAngle, 0});
    for (std::size_t c = 0; c < model.cameras.size(); ++c) {
        const Eigen::Vector3f to_camera = (model.cameras[c].centre_site - middle).normalized();
        // chord of the unit circle instead of the angle
        std::pair<float, std::size_t> next{kStripAngleFloor + (to_eye - to_camera).norm(), c};
        for (auto& kept : nearest)
            if (next < kept) std::swap(next, kept);
    }
    StripCameras cameras;
    float sum = 0.0F;
    const std::size_t layer_bytes = static_cast<std::size_t>(model.layer_width) *
                                    static_cast<std::size_t>(model.layer_height) * 4;
    for (std::size_t k = 0; k < kStripCameras; ++k) {
        const auto [angle, index] = nearest[k];
        const PersonModel::Camera& camera = model.cameras[index];
        const float root = std::max(1.0F - angle / nearest[kStripCameras].first, 0.0F) / angle;
        const float weight = angle < kNoAngle ? root * root : 0.0F;
        cameras[k] = {index,
                      weight,
                      camera.centre_site,
                      layer_from_site(camera),
                      camera.layer_coordinates.data(),
                      model.layers.data() + index * layer_bytes};
        sum += weight;
    }
    // all in one direction
    if (!(sum > 0.0F)) cameras[0].weight = sum = 1.0F;
    for (StripCamera& camera : cameras) camera.weight /= sum;
    return cameras;
}

// An end of a part of the strip.
struct StripEnd {
    OutlineStrip::Crossing crossing;
    float share = 0.0F;  // of the way along the crossing's edge
    Eigen::Vector3f position_site = Eigen::Vector3f::Zero();
    Eigen::Vector3f outwards = Eigen::Vector3f::Zero();    // unit, perpendicular to the view
    Eigen::Vector3f width_site = Eigen::Vector3f::Zero();  // from the inner to the outer vertex
    Weights weights{};
    float seen = 0.0F;  // their sum
    Eigen::Vector3f colour = Eigen::Vector3f::Zero();
};

class StripFinder {
public:
    StripFinder(const PersonModel& model,
                const Eigen::Vector3f& eye_site,
                const float* cos_eye,
                const OutlineStripOptions& options,
                std::vector<float>& out)
        : model_(model),
          eye_site_(eye_site),
          cos_eye_(cos_eye),
          options_(options),
          cameras_(cameras_for(model, eye_site)),
          layer_size_(model.layer_width, model.layer_height),
          out_(out) {
        const PersonModel::Camera& first = model.cameras[cameras_[0].index];
        const float px_per_texel =
            static_cast<float>(first.crop_px.width) /
            ((first.high_st - first.low_st).x() * static_cast<float>(model.layer_width));
        width_per_depth_ =
            options.width_texels * px_per_texel / static_cast<float>(first.intrinsics.fx);
    }

    // Adds the part of the strip that begins at `first` and goes on with `next`, to its end or
    // until it comes back.
    void follow(std::vector<OutlineStrip::Crossing>& crossings,
                std::uint32_t first,
                std::uint32_t next) {
        constexpr std::uint32_t kNone = OutlineStrip::Crossing::kNone;
        const float part_sq = options_.part_m * options_.part_m;
        StripEnd end = end_at(crossings[first]);
        std::uint32_t before = first;
        std::uint32_t at = next;
        while (at != kNone) {
            OutlineStrip::Crossing& crossing = crossings[at];
            const std::uint32_t after =
                crossing.next[crossing.next[0] == before && crossing.next[1] != before ? 1 : 0];
            const bool is_last = at == first || crossing.is_done || after == kNone;
            const Eigen::Vector3f position = between(model_.vertices_site, crossing);
            if (is_last || (position - end.position_site).squaredNorm() >= part_sq) {
                const StripEnd here = end_at(crossing);
                add(end, here);
                end = here;
            }
            crossing.is_done = true;
            if (is_last) return;
            before = at;
            at = after;
        }
    }

private:
    void add(const StripEnd& a, const StripEnd& b) {
        if (std::max(a.seen, b.seen) <= kLeastSeen) return;
        std::array<std::array<float, kFloats>, 4> corners;
        write(a, Eigen::Vector3f::Zero(), corners[0].data());
        write(a, a.width_site, corners[1].data());
        write(b, Eigen::Vector3f::Zero(), corners[2].data());
        write(b, b.width_site, corners[3].data());
        for (const std::size_t i : {0U, 1U, 2U, 2U, 1U, 3U})
            out_.insert(out_.end(), corners[i].begin(), corners[i].end());
    }

    float share_of(const OutlineStrip::Crossing& crossing) const {
        const float at_from = cos_eye_[crossing.from];
        return at_from / (at_from - cos_eye_[crossing.to]);
    }
    Eigen::Vector3f between(const std::vector<Eigen::Vector3f>& all,
                            const OutlineStrip::Crossing& crossing) const {
        return all[crossing.from] + share_of(crossing) * (all[crossing.to] - all[crossing.from]);
    }

    StripEnd end_at(const OutlineStrip::Crossing& crossing) const {
        StripEnd end;
        end.crossing = crossing;
        end.share = share_of(crossing);
        end.position_site = between(model_.vertices_site, crossing);
        const Eigen::Vector3f view = (end.position_site - eye_site_).normalized();
        const Eigen::Vector3f normal = between(model_.normals, crossing);
        end.outwards = (normal - normal.dot(view) * view).normalized();
        // an absurd lens, or a place behind the camera, has no width
        const float width_m =
            in_layer(cameras_[0], end, Eigen::Vector3f::Zero()).z() * width_per_depth_;
        end.width_site = (width_m > 0.0F ? std::min(width_m, kMostWidth_m) : 0.0F) * end.outwards;
        const Eigen::Vector3f far_out =
            options_.end_texels / options_.width_texels * end.width_site;
        for (std::size_t k = 0; k < kStripCameras; ++k) {
            if (cameras_[k].weight < kLeastStripWeight) continue;
            end.weights[k] = cameras_[k].weight * share_of_outline(cameras_[k], end, far_out);
            end.seen += end.weights[k];
        }
        end.colour = colour_at(end);
        return end;
    }

    Eigen::Vector3f in_layer(const StripCamera& camera,
                             const StripEnd& end,
                             const Eigen::Vector3f& offset_site) const {
        const Eigen::Vector3f& from = camera.coordinates[end.crossing.from];
        const Eigen::Vector3f& to = camera.coordinates[end.crossing.to];
        return from + end.share * (to - from) + camera.layer_from_site * offset_site;
    }

    // RGBA at layer coordinates (s z, t z, z), nearest texel. Null outside of the layer.
    const std::uint8_t* texel(const StripCamera& camera, const Eigen::Vector3f& st) const {
        const Eigen::Array2f at = st.head<2>().array() / st.z() * layer_size_.cast<float>();
        if (!((at >= 0.0F).all() && (at < layer_size_.cast<float>()).all())) return nullptr;
        return camera.layer + 4 * (std::ptrdiff_t{static_cast<int>(at.y())} * layer_size_.x() +
                                   static_cast<int>(at.x()));
    }

    // From 1, if the camera sees the outline there, to 0. A surface that the camera sees from its
    // front or back has another outline there, and its mask is larger although nothing disagrees.
    float share_of_outline(const StripCamera& camera,
                           const StripEnd& end,
                           const Eigen::Vector3f& far_out_site) const {
        const std::uint8_t* const rgba = texel(camera, in_layer(camera, end, far_out_site));
        if (rgba != nullptr && rgba[3] != 0) return 0.0F;
        const float cosine =
            end.outwards.dot((camera.centre_site - end.position_site).normalized()) /
            options_.most_cosine;
        return std::max(0.0F, 1.0F - cosine * cosine);
    }

    // In [0, 1]: what the cameras see of the surface there. Where the strip shows, that is at least
    // a texel inside their masks: beside the outline texels mix with the background.
    Eigen::Vector3f colour_at(const StripEnd& end) const {
        Eigen::Vector4f sum = Eigen::Vector4f::Zero();
        for (std::size_t k = 0; k < kStripCameras; ++k) {
            if (!(end.weights[k] > 0.0F)) continue;
            const std::uint8_t* const rgba =
                texel(cameras_[k], in_layer(cameras_[k], end, Eigen::Vector3f::Zero()));
            if (rgba == nullptr) continue;
            sum +=
                end.weights[k] * Eigen::Vector4i(rgba[0], rgba[1], rgba[2], rgba[3]).cast<float>();
        }
        if (sum.w() > 1.0F) return sum.head<3>() / sum.w();
        return between(model_.fallback, end.crossing);
    }

    void write(const StripEnd& end, const Eigen::Vector3f& offset_site, float* vertex) const {
        const Eigen::Vector3f place = end.position_site + offset_site;
        const Eigen::Vector3f position =
            place + options_.behind_m * (place - eye_site_).normalized();
        std::copy_n(position.data(), 3, vertex);
        std::copy_n(end.colour.data(), 3, vertex + 3);
        float* const layers = vertex + 6;
        float* pictures = layers + kStripCameras;
        for (std::size_t k = 0; k < kStripCameras; ++k, pictures += 4) {
            layers[k] = static_cast<float>(cameras_[k].index);
            const Eigen::Vector3f st = in_layer(cameras_[k], end, offset_site);
            std::copy_n(st.data(), 3, pictures);
            pictures[3] = end.weights[k];
        }
    }

    const PersonModel& model_;
    Eigen::Vector3f eye_site_;
    const float* cos_eye_;  // per vertex: cosine between the normal and the direction to the eye
    const OutlineStripOptions& options_;
    StripCameras cameras_;
    Eigen::Array2i layer_size_;
    float width_per_depth_ = 0.0F;
    std::vector<float>& out_;
};

}  // namespace

std::uint32_t OutlineStrip::crossing_of(std::uint32_t a, std::uint32_t b) {
    const auto [from, to] = std::minmax(a, b);
    const std::size_t mask = slots_.size() - 1;
    const std::uint64_t mixed = ((std::uint64_t{from} << 32U) | to) * 0x9e3779b97f4a7c15U;
    for (std::size_t slot = (mixed >> 32U) & mask;; slot = (slot + 1) & mask) {
        const std::uint32_t found = slots_[slot];
        if (found == Crossing::kNone) {
            slots_[slot] = static_cast<std::uint32_t>(crossings_.size());
            crossings_.push_back({from, to});
            return slots_[slot];
        }
        if (crossings_[found].from == from && crossings_[found].to == to) return found;
    }
}

void OutlineStrip::find_crossings(const PersonModel& model, const float* cos_eye) {
    const auto faces_eye = [&](std::uint32_t vertex) { return cos_eye[vertex] > 0.0F; };
    crossed_.clear();
    for (const auto& triangle : model.triangles) {
        const bool first = faces_eye(triangle[0]);
        if (first != faces_eye(triangle[1]) || first != faces_eye(triangle[2]))
            crossed_.push_back(triangle);
    }
    crossings_.clear();
    // two edges each, at most, and half of the slots empty
    slots_.assign(std::bit_ceil(std::max<std::size_t>(4 * crossed_.size(), 16)), Crossing::kNone);
    for (const auto& triangle : crossed_) {
        std::array<std::uint32_t, 2> ends{};
        std::size_t num_ends = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = triangle[k];
            const std::uint32_t b = triangle[(k + 1) % 3];
            if (faces_eye(a) != faces_eye(b)) ends[num_ends++] = crossing_of(a, b);
        }
        for (const std::size_t i : {0U, 1U}) {
            // more than two only in a mesh that is no manifold
            auto& next = crossings_[ends[i]].next;
            const auto free = std::ranges::find(next, Crossing::kNone);
            if (free != next.end()) *free = ends[1 - i];
        }
    }
}

void OutlineStrip::find(const PersonModel& model,
                        const Eigen::Vector3f& eye_site,
                        const BlendScratch& blended,
                        const OutlineStripOptions& options) {
    vertices_.clear();
    if (model.cameras.empty() || model.triangles.empty()) return;
    const float* cos_eye = blended.cos_eye.data();
    find_crossings(model, cos_eye);
    StripFinder finder(model, eye_site, cos_eye, options, vertices_);
    // of a closed mesh all outlines are closed; open ones begin at an end
    for (const bool is_open : {true, false}) {
        for (std::uint32_t i = 0; i < crossings_.size(); ++i) {
            Crossing& first = crossings_[i];
            if (first.is_done || (is_open && first.next[1] != Crossing::kNone)) continue;
            first.is_done = is_open;
            finder.follow(crossings_, i, first.next[0]);
            crossings_[i].is_done = true;
        }
    }
}

}  // namespace atrium::renderer
