#include "filmed_room.hpp"

#include "tools/calibrate/board/print_board.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace atrium::calibrate_test {
namespace {

using calibrate::Board;

Eigen::Quaterniond looking(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double roll) {
    const Eigen::Vector3d z = (to - from).normalized();
    const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d camera_from_site;
    camera_from_site << x.transpose(), z.cross(x).transpose(), z.transpose();
    return Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()) * Eigen::Quaterniond(camera_from_site);
}

geometry::CalibratedCamera camera_of(std::size_t i, const ShowOptions& options, std::mt19937& rng) {
    std::uniform_real_distribution<double> vary(-1.0, 1.0);
    const double angle = 2.0 * std::numbers::pi * options.ring *
                         (static_cast<double>(i) + 0.2 * vary(rng)) /
                         static_cast<double>(options.num_cameras);
    const double r = options.distance_m;
    const Eigen::Vector3d centre(r * std::cos(angle), r * std::sin(angle), 1.7 + 0.5 * vary(rng));
    const Eigen::Vector3d target(0.15 * vary(rng), 0.15 * vary(rng), 1.1);
    geometry::CalibratedCamera camera;
    camera.name = fmt::format("cam{}", i);
    camera.camera_from_site.rotation = looking(centre, target, 0.05 * vary(rng));
    camera.camera_from_site.translation = -(camera.camera_from_site.rotation * centre);
    geometry::PinholeCamera& lens = camera.intrinsics;
    lens.width = 1280;
    lens.height = 960;
    lens.fx = lens.fy = 900.0 + 150.0 * vary(rng);
    lens.cx = 639.5 + 10.0 * vary(rng);
    lens.cy = 479.5 + 10.0 * vary(rng);
    lens.distortion = {
        -0.15 + 0.06 * vary(rng), 0.05 + 0.03 * vary(rng), 4e-4 * vary(rng), 4e-4 * vary(rng), 0.0};
    return camera;
}

// In the middle, leaning to all sides, and turned to one or between two cameras.
geometry::RigidTransform board_at(double instant,
                                  const Board& board,
                                  const FilmedRoom& room,
                                  const ShowOptions& options,
                                  const std::vector<double>& phases) {
    const auto wave = [&](std::size_t k, double turns) {
        return std::sin(2.0 * std::numbers::pi * turns * instant / 60.0 + phases[k]);
    };
    const Eigen::Vector3d middle(
        0.35 * wave(0, 3.1), 0.35 * wave(1, 2.3), 1.1 + 0.3 * wave(2, 4.3));
    const std::size_t n = room.cameras.size();
    // from one camera to the next, at an even pace
    const double turn = options.is_frontal ? 0.0 : 2.0 * static_cast<double>(n) * instant / 60.0;
    const auto at = static_cast<std::size_t>(turn) % n;
    const double between = turn - std::floor(turn);
    const Eigen::Vector3d from = room.cameras[at].centre_site();
    const Eigen::Vector3d to = room.cameras[(at + 1) % n].centre_site();
    const Eigen::Vector3d towards = (1.0 - between) * from + between * to;
    const Eigen::Vector3d z = (towards - middle).normalized();
    const Eigen::Vector3d x = Eigen::Vector3d::UnitZ().cross(z).normalized();
    Eigen::Matrix3d axes;
    axes << x, z.cross(x), z;
    geometry::RigidTransform pose;
    const double lean = options.is_frontal ? 0.0 : 0.6;
    pose.rotation = Eigen::Quaterniond(axes) *
                    Eigen::AngleAxisd(lean * wave(3, 5.3), Eigen::Vector3d::UnitX()) *
                    Eigen::AngleAxisd(lean * wave(4, 4.1), Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(1.5 * wave(5, 1.7), Eigen::Vector3d::UnitZ());
    pose.translation =
        middle - pose.rotation * Eigen::Vector3d(0.5 * board.columns * board.square_m,
                                                 0.5 * board.rows * board.square_m,
                                                 0.0);
    return pose;
}

}  // namespace

Board large_board() {
    Board board;
    board.square_m = 0.06;
    board.marker_m = 0.045;
    return board;
}

FilmedRoom show(const std::vector<Board>& boards, const ShowOptions& options) {
    std::mt19937 rng(options.seed);
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    std::normal_distribution<double> noise(0.0, options.noise_px);
    FilmedRoom room;
    room.boards = boards;
    for (std::size_t i = 0; i < options.num_cameras; ++i)
        room.cameras.push_back(camera_of(i, options, rng));
    std::vector<double> phases;
    for (std::size_t i = 0; i < 6 * boards.size(); ++i)
        phases.push_back(2.0 * std::numbers::pi * chance(rng));
    const auto pose_of = [&](std::size_t b, double instant) {
        const std::vector<double> own(phases.begin() + static_cast<std::ptrdiff_t>(6 * b),
                                      phases.begin() + static_cast<std::ptrdiff_t>(6 * b + 6));
        return board_at(instant, boards[b], room, options, own);
    };
    for (std::uint32_t instant = 0; instant < options.num_instants; ++instant)
        room.site_from_board.push_back(pose_of(0, instant / options.rest * options.rest));
    for (std::size_t c = 0; c < room.cameras.size(); ++c) {
        const geometry::CalibratedCamera& camera = room.cameras[c];
        const geometry::PinholeCamera& lens = camera.intrinsics;
        const bool is_last = c + 1 == room.cameras.size();
        calibrate::BoardCamera seen{camera.name, lens.width, lens.height, options.num_instants, {}};
        for (std::uint32_t instant = 0; instant < options.num_instants; ++instant) {
            std::uint32_t first = 0;
            // drawn only if wanted, so that rooms with a trigger stay as they are
            const bool jitters =
                options.jitter_instants > 0.0 &&
                (options.jitter_share >= 1.0 || chance(rng) < options.jitter_share);
            const double jitter =
                jitters ? options.jitter_instants * (2.0 * chance(rng) - 1.0) : 0.0;
            for (std::size_t b = 0; b < boards.size(); ++b) {
                const double time = instant / options.rest * options.rest - jitter -
                                    (is_last ? options.late_instants : 0.0);
                const auto camera_from_board = camera.camera_from_site * pose_of(b, time);
                const Eigen::Vector3d middle =
                    camera_from_board * boards[b].corner_m(boards[b].num_corners() / 2);
                const Eigen::Vector3d facing =
                    camera_from_board.rotation * Eigen::Vector3d::UnitZ();
                std::vector<calibrate::BoardCorner> corners;
                for (std::uint32_t i = 0; i < boards[b].num_corners(); ++i) {
                    const Eigen::Vector3d p = camera_from_board * boards[b].corner_m(i);
                    if (p.z() < 0.2) continue;
                    Eigen::Vector2d px = lens.distort(lens.project(p));
                    px += Eigen::Vector2d(noise(rng), noise(rng));
                    if (chance(rng) < options.outliers)
                        px += 40.0 * Eigen::Vector2d(chance(rng) - 0.5, chance(rng) - 0.5);
                    if (px.x() < 3 || px.y() < 3 || px.x() > lens.width - 4 ||
                        px.y() > lens.height - 4)
                        continue;
                    if (is_last && options.is_last_mirrored) px.x() = lens.width - 1 - px.x();
                    corners.push_back({instant, first + i, px});
                }
                constexpr double kSeen = 0.35;  // cosine of the angle to the board's normal
                if (-facing.dot(middle.normalized()) > kSeen && corners.size() >= 6)
                    seen.corners.insert(seen.corners.end(), corners.begin(), corners.end());
                first += static_cast<std::uint32_t>(boards[b].num_corners());
            }
        }
        room.points.push_back(std::move(seen));
    }
    return room;
}

calibrate::GrayPicture photograph(const Board& board,
                                  const geometry::PinholeCamera& lens,
                                  const geometry::RigidTransform& camera_from_board) {
    // the board at 0.25 mm, with a border
    constexpr double kCell_m = 0.00025;
    const double border = 0.5 * board.square_m;
    const auto cells = [&](double metres) {
        return static_cast<int>(std::lround(metres / kCell_m));
    };
    const int width = cells(2.0 * border + board.columns * board.square_m);
    const int height = cells(2.0 * border + board.rows * board.square_m);
    const std::uint8_t light = board.is_inverted ? 25 : 230, dark = board.is_inverted ? 230 : 25;
    std::vector<std::uint8_t> printed(static_cast<std::size_t>(width) * height, light);
    for (const calibrate::PrintedRect& r : calibrate::printed_rects(board))
        for (int y = cells(border + r.bottom); y < cells(border + r.bottom + r.height); ++y)
            std::fill_n(
                printed.begin() + static_cast<std::ptrdiff_t>(y) * width + cells(border + r.left),
                cells(border + r.left + r.width) - cells(border + r.left),
                dark);
    const geometry::RigidTransform board_from_camera = camera_from_board.inverse();
    calibrate::GrayPicture picture{lens.width, lens.height, {}};
    std::mt19937 grain(7);
    for (int y = 0; y < lens.height; ++y) {
        for (int x = 0; x < lens.width; ++x) {
            // the lens is about linear within a pixel
            const auto ray_at = [&](double px_x, double px_y) -> Eigen::Vector3d {
                const auto px = lens.undistort({px_x, px_y});
                return px ? lens.ray_camera(*px) : Eigen::Vector3d(0.0, 0.0, -1.0);
            };
            const Eigen::Vector3d ray_camera = ray_at(x, y);
            const Eigen::Vector3d to_x = ray_at(x + 1.0 / 3, y) - ray_camera;
            const Eigen::Vector3d to_y = ray_at(x, y + 1.0 / 3) - ray_camera;
            double sum = 0.0;
            for (const double dy : {-1.0, 0.0, 1.0}) {
                for (const double dx : {-1.0, 0.0, 1.0}) {
                    const Eigen::Vector3d ray =
                        board_from_camera.rotation * (ray_camera + dx * to_x + dy * to_y);
                    const Eigen::Vector3d& start = board_from_camera.translation;
                    const Eigen::Vector3d at = start - ray * (start.z() / ray.z());
                    const int column = static_cast<int>(std::floor((at.x() + border) / kCell_m));
                    const int row = static_cast<int>(std::floor((at.y() + border) / kCell_m));
                    const bool is_on = start.z() * ray.z() < 0.0 && column >= 0 && row >= 0 &&
                                       column < width && row < height;
                    sum += is_on ? printed[static_cast<std::size_t>(row) * width + column] : 120.0;
                }
            }
            picture.pixels.push_back(static_cast<std::uint8_t>(
                std::clamp(sum / 9.0 + static_cast<double>(grain() % 5) - 2.0, 0.0, 255.0)));
        }
    }
    return picture;
}

double centres_off_m(const std::vector<geometry::CalibratedCamera>& truth,
                     const std::vector<Eigen::Vector3d>& found) {
    const auto n = static_cast<Eigen::Index>(truth.size());
    Eigen::Matrix3Xd to(3, n), from(3, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        to.col(i) = truth[static_cast<std::size_t>(i)].centre_site();
        from.col(i) = found[static_cast<std::size_t>(i)];
    }
    const Eigen::Matrix4d fit = Eigen::umeyama(from, to, false);
    const Eigen::Matrix3Xd off =
        ((fit.topLeftCorner<3, 3>() * from).colwise() + fit.topRightCorner<3, 1>()) - to;
    return std::sqrt(off.squaredNorm() / static_cast<double>(n));
}

}  // namespace atrium::calibrate_test
