#include "simulation/board_room.hpp"

#include "simulation/hash.hpp"
#include "simulation/person.hpp"
#include "simulation/room.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>

namespace atrium::simulation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWhite_lsb = 225.0, kBlack_lsb = 25.0, kBack_lsb = 110.0;
constexpr double kNearest_m = 0.1;  // from the camera; nearer boards are looked for everywhere
constexpr double kRound_s = 30.0;
constexpr double kLean_rad = 0.6;
constexpr int kMarkerCells = 6;        // with the black border
constexpr double kMarkerShare = 0.75;  // of a square
constexpr std::array<std::uint16_t, 17> kMarkers{
    // of DICT_4X4_50, rows from the top left, 1 = white
    0xb532,
    0x0f9a,
    0x332d,
    0x9946,
    0x549e,
    0x79cd,
    0x9e2e,
    0xc4f2,
    0xfeda,
    0xcf56,
    0xf991,
    0x11a7,
    0x0eb7,
    0x2a0f,
    0x24b1,
    0x263e,
    0x4665};

image::Plane grey_of(const RoomView& view) {
    image::Plane plane(view.width & ~1, view.height & ~1);
    for (int y = 0; y < plane.height; ++y) {
        const std::uint8_t* bgr = view.bgr.data() + static_cast<std::ptrdiff_t>(3) * y * view.width;
        for (int x = 0; x < plane.width; ++x, bgr += 3)
            plane.row(y)[x] =
                static_cast<std::uint8_t>((29 * bgr[0] + 150 * bgr[1] + 77 * bgr[2]) >> 8);
    }
    return plane;
}

double lightness(const Vector2d& p_board, double square_m, bool is_front, double behind_lsb) {
    const auto black = is_black(p_board, square_m);
    if (!black) return behind_lsb;
    if (!is_front) return kBack_lsb;
    return *black ? kBlack_lsb : kWhite_lsb;
}

}  // namespace

std::optional<bool> is_black(const Vector2d& p_board, double square_m) {
    const Vector2d p = p_board / square_m;  // in squares
    if (p.x() < -0.5 || p.y() < -0.5 || p.x() > kBoardColumns + 0.5 || p.y() > kBoardRows + 0.5)
        return std::nullopt;
    const int column = static_cast<int>(std::floor(p.x()));
    const int row = static_cast<int>(std::floor(kBoardRows - p.y()));  // from the top
    if (column < 0 || row < 0 || column >= kBoardColumns || row >= kBoardRows) return false;
    if ((column + row) % 2 == 0) return true;
    // a white square: every second one has been counted
    const auto marker = static_cast<std::size_t>((row * kBoardColumns + column) / 2);
    const double scale = kMarkerCells / kMarkerShare, gap = 0.5 * (1.0 - kMarkerShare);
    const int x = static_cast<int>(std::floor(scale * (p.x() - column - gap)));
    const int y = static_cast<int>(std::floor(scale * (kBoardRows - p.y() - row - gap)));
    if (x < 0 || y < 0 || x >= kMarkerCells || y >= kMarkerCells) return false;
    if (x == 0 || y == 0 || x == kMarkerCells - 1 || y == kMarkerCells - 1) return true;
    return (kMarkers[marker] >> (15 - 4 * (y - 1) - (x - 1)) & 1) == 0;
}

BoardRoom::BoardRoom(const config::Rig& rig, const BoardRoomOptions& options)
    : cameras_(rig.cameras),
      bounds_site_(rig.bounds_site),
      options_(options),
      noise_(options.noise_lsb, options.seed) {
    std::mt19937_64 rng(hash_of(options.seed, 0));
    std::uniform_real_distribution<double> turn(0.0, 2.0 * std::numbers::pi);
    for (int i = 0; i < 6; ++i) phases_rad_.push_back(turn(rng));
    const Room room = make_room(cameras_, {});
    for (const geometry::CalibratedCamera& camera : cameras_) {
        empty_.push_back(grey_of(view_room(room, camera.intrinsics, camera.camera_from_site)));
        around_.push_back(camera.centre_site());
    }
    const Vector3d middle = 0.5 * (bounds_site_.min + bounds_site_.max);
    std::ranges::stable_sort(around_, {}, [&](const Vector3d& centre) {
        return std::atan2(centre.y() - middle.y(), centre.x() - middle.x());
    });
}

geometry::RigidTransform BoardRoom::site_from_board(double time_s) const {
    if (options_.lies) return {};
    const auto wave = [&](std::size_t k, double hz) {
        return std::sin(2.0 * std::numbers::pi * hz * time_s + phases_rad_[k]);
    };
    const Vector3d half = 0.5 * bounds_site_.size();
    const Vector3d middle = 0.5 * (bounds_site_.min + bounds_site_.max) +
                            half.cwiseProduct(Vector3d(
                                0.8 * wave(0, 0.103), 0.8 * wave(1, 0.077), 0.6 * wave(2, 0.143)));
    // from one camera to the next, at an even pace
    const auto num = static_cast<double>(around_.size());
    const double place = num * (time_s / kRound_s - std::floor(time_s / kRound_s));
    const auto at = std::min(static_cast<std::size_t>(place), around_.size() - 1);
    const double share = place - std::floor(place);
    const Vector3d towards =
        (1.0 - share) * around_[at] + share * around_[(at + 1) % around_.size()];
    const Vector3d z = (towards - middle).normalized();
    const Vector3d level = Vector3d::UnitZ().cross(z);
    const Vector3d x = level.norm() > 1e-3 ? level.normalized() : Vector3d::UnitX();
    Eigen::Matrix3d axes;
    axes << x, z.cross(x).normalized(), z;
    geometry::RigidTransform pose;
    pose.rotation = Eigen::Quaterniond(axes) *
                    Eigen::AngleAxisd(kLean_rad * wave(3, 0.177), Vector3d::UnitX()) *
                    Eigen::AngleAxisd(kLean_rad * wave(4, 0.137), Vector3d::UnitY()) *
                    Eigen::AngleAxisd(1.5 * wave(5, 0.057), Vector3d::UnitZ());
    pose.translation = middle - pose.rotation * Vector3d(0.5 * kBoardColumns * options_.square_m,
                                                         0.5 * kBoardRows * options_.square_m,
                                                         0.0);
    return pose;
}

void BoardRoom::draw_board(const geometry::RigidTransform& camera_from_board,
                           const geometry::PinholeCamera& lens,
                           image::Plane& out) const {
    const double square = options_.square_m;
    Eigen::Array2d low(out.width, out.height), high(0.0, 0.0);
    for (const double x : {-0.5, 0.5 * kBoardColumns, kBoardColumns + 0.5}) {
        for (const double y : {-0.5, 0.5 * kBoardRows, kBoardRows + 0.5}) {
            const Vector3d p = camera_from_board * Vector3d(square * x, square * y, 0.0);
            if (p.z() < kNearest_m) {
                low.setZero();
                high = Eigen::Array2d(out.width, out.height);
                continue;
            }
            const Eigen::Array2d px = lens.distort(lens.project(p)).array();
            low = low.min(px);
            high = high.max(px);
        }
    }
    constexpr double kMargin_px = 8.0;  // for edges that the lens bends
    const int x0 = std::max(0, static_cast<int>(std::max(low.x() - kMargin_px, 0.0)));
    const int y0 = std::max(0, static_cast<int>(std::max(low.y() - kMargin_px, 0.0)));
    const int x1 = static_cast<int>(std::min(high.x() + kMargin_px, out.width - 1.0));
    const int y1 = static_cast<int>(std::min(high.y() + kMargin_px, out.height - 1.0));
    const geometry::RigidTransform board_from_camera = camera_from_board.inverse();
    const Vector3d& eye = board_from_camera.translation;
    const auto ray_at = [&](double x, double y) -> Vector3d {
        const auto px = lens.undistort({x, y});
        return px ? Vector3d(board_from_camera.rotation * lens.ray_camera(*px)) : Vector3d::Zero();
    };
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            // the lens is about linear within a pixel
            const Vector3d ray = ray_at(x, y);
            const Vector3d to_x = ray_at(x + 1.0 / 3.0, y) - ray;
            const Vector3d to_y = ray_at(x, y + 1.0 / 3.0) - ray;
            double sum = 0.0;
            for (const double dy : {-1.0, 0.0, 1.0}) {
                for (const double dx : {-1.0, 0.0, 1.0}) {
                    const Vector3d along = ray + dx * to_x + dy * to_y;
                    const bool is_ahead = eye.z() * along.z() < 0.0;
                    const Vector3d at = eye - along * (is_ahead ? eye.z() / along.z() : 0.0);
                    const double behind = out.row(y)[x];
                    sum +=
                        is_ahead ? lightness(at.head<2>(), square, eye.z() > 0.0, behind) : behind;
                }
            }
            out.row(y)[x] = static_cast<std::uint8_t>(std::lround(sum / 9.0));
        }
    }
}

void BoardRoom::render(double time_s, std::size_t camera, image::Plane& out) const {
    out = empty_[camera];
    draw_board(cameras_[camera].camera_from_site * site_from_board(time_s),
               cameras_[camera].intrinsics,
               out);
    add_noise(hash_of(microseconds(time_s), camera), out);
}

void BoardRoom::render_empty(std::uint64_t shot, std::size_t camera, image::Plane& out) const {
    out = empty_[camera];
    add_noise(hash_of(~shot, camera), out);
}

void BoardRoom::add_noise(std::uint64_t picture, image::Plane& out) const {
    for (int y = 0; y < out.height; ++y)
        noise_.add(picture, y, std::span(out.row(y), static_cast<std::size_t>(out.width)));
}

}  // namespace atrium::simulation
