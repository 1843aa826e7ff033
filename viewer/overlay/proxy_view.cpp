#include "viewer/overlay/proxy_view.hpp"

#include "core/bus/limits.hpp"
#include "core/bus/proxy_points.hpp"
#include "viewer/overlay/shape_wires.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace atrium::viewer {
namespace {

using renderer::Line;

constexpr auto kSilent = std::chrono::seconds(1);
constexpr std::size_t kMaxPeople = 64;      // sites of a world
constexpr std::size_t kMaxPoints = 32'768;  // drawn per picture, all people together
constexpr double kTickM = 0.015;
constexpr double kWayS = 0.1;  // a motion line ends where the surfel will be after this time
constexpr double kSlowestSurfelMps = 0.05;  // slower surfels get no motion line
constexpr double kCrossM = 0.02;            // half the size of a contact's cross
const Eigen::Vector3f kTouchColour(1.0f, 0.2f, 0.9f);

template <typename Key, typename Message, typename Known, typename Make>
void apply(std::map<Key, std::optional<Message>>& changes,
           std::map<Key, Known>& known,
           std::size_t max,
           const Make& make) {
    for (auto& [key, message] : changes) {
        if (!message)
            known.erase(key);
        else if (known.size() < max || known.contains(key))
            known.insert_or_assign(key, make(std::move(*message)));
    }
}

void append_cross(const Eigen::Vector3d& at, std::vector<Line>& lines) {
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d arm = kCrossM * Eigen::Vector3d::Unit(axis);
        append_line(at - arm, at + arm, kTouchColour, lines);
    }
}

}  // namespace

Eigen::Vector3f colour_of_speed(double speed_mps) {
    struct Stop {
        double speed_mps;
        Eigen::Vector3f colour;
    };
    static const std::array<Stop, 4> kStops{{{0.0, {0.3f, 0.55f, 1.0f}},
                                             {0.5, {0.15f, 0.9f, 0.35f}},
                                             {1.5, {1.0f, 0.85f, 0.1f}},
                                             {3.0, {1.0f, 0.15f, 0.1f}}}};
    for (std::size_t i = 1; i < kStops.size(); ++i) {
        const Stop& low = kStops[i - 1];
        const Stop& high = kStops[i];
        if (speed_mps > high.speed_mps) continue;
        const auto share =
            static_cast<float>((speed_mps - low.speed_mps) / (high.speed_mps - low.speed_mps));
        return low.colour + share * (high.colour - low.colour);
    }
    return kStops.back().colour;
}

void ProxyView::update(ProxyChanges changes, Clock::time_point now) {
    apply(changes.people, people_, kMaxPeople, [&](bus::PersonProxy&& proxy) {
        return Person{std::move(proxy), now};
    });
    apply(changes.objects, objects_, bus::kMaxObjects, [](bus::ObjectProxy&& proxy) {
        return std::move(proxy);
    });
    std::erase_if(people_, [&](const auto& item) { return now - item.second.came > kSilent; });
}

void ProxyView::clear() {
    people_.clear();
    objects_.clear();
}

void ProxyView::append_people(std::vector<Line>& lines) const {
    std::size_t num_left = kMaxPoints;
    for (const auto& [site, person] : people_) {
        const bus::PersonProxy& proxy = person.proxy;
        const std::size_t num = std::min(num_left, proxy.points.size());
        num_left -= num;
        for (std::size_t i = 0; i < num; ++i) {
            const Eigen::Vector3d at = bus::place_of(proxy, i);
            const Eigen::Vector3d velocity = bus::velocity_of(proxy.points[i]);
            const double speed_mps = velocity.norm();
            const Eigen::Vector3f colour = colour_of_speed(speed_mps);
            append_line(at, at + kTickM * bus::normal_of(proxy.points[i]), colour, lines);
            if (speed_mps > kSlowestSurfelMps)
                append_line(at, at + kWayS * velocity, colour, lines);
        }
        for (const bus::Touch& touch : proxy.touches) append_cross(touch.point_world, lines);
    }
}

bool ProxyView::append_edges(std::uint32_t object,
                             const Eigen::Matrix4d& world_from_object,
                             const Eigen::Vector3f& colour,
                             std::vector<Line>& lines) const {
    const auto found = objects_.find(object);
    if (found == objects_.end()) return false;
    const auto in_world = [&](std::size_t vertex) -> Eigen::Vector3d {
        const Eigen::Vector3d p_object = bus::vertex_of(found->second, vertex);
        return (world_from_object * p_object.homogeneous()).head<3>();
    };
    for (const auto& [from, to] : found->second.edges)
        append_line(in_world(from), in_world(to), colour, lines);
    return true;
}

}  // namespace atrium::viewer
