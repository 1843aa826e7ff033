#include "viewer/control/scene_editor.hpp"

#include "core/bus/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr double kBeforeTheEyeM = 1.2;  // to the nearest point of the object, roughly
constexpr double kFarthestM = 6.0;
constexpr double kStepM = 0.1;
constexpr double kLowestInView = -0.8;  // in half picture heights, below the middle
constexpr double kOffTheFloorM = 0.01;
constexpr double kAsideStepM = 0.1;
constexpr int kAsideSteps = 30;
constexpr double kMostAside = 0.8;  // in half picture widths
constexpr double kMinSizeM = 0.02;
constexpr double kMaxSizeM = 4.0;
// pending commands watched; the world accepts 200 commands a second
constexpr std::size_t kMaxPendingEdits = 64;

std::string valid_name(std::string name, bus::Shape shape) {
    name = name.substr(0, 63);
    for (char& c : name) {
        if (!bus::is_valid_name({&c, 1})) c = '_';
    }
    if (!name.empty()) return name;
    switch (shape) {
        case bus::Shape::kSphere:
            return "ball";
        case bus::Shape::kCylinder:
            return "cylinder";
        case bus::Shape::kCapsule:
            return "capsule";
        default:
            return "box";
    }
}

// Normalises the size for the shape.
Eigen::Vector3d size_of(const NewObject& wanted) {
    const Eigen::Vector3d size = wanted.size_m.cwiseMax(kMinSizeM).cwiseMin(kMaxSizeM);
    if (wanted.shape == bus::Shape::kSphere) return Eigen::Vector3d::Constant(size.x());
    if (wanted.shape == bus::Shape::kCylinder) return {size.x(), size.x(), size.z()};
    if (wanted.shape == bus::Shape::kCapsule)
        return {size.x(), size.x(), std::max(size.x(), size.z())};
    return size;
}

// Place on the view axis, far enough that the object's foot is visible after it falls to the floor.
Eigen::Vector3d place_before(const renderer::EyeView& eye, const Eigen::Vector3d& size_m) {
    const Eigen::Vector3d forward = -eye.view_from_world.row(2).head<3>().transpose();
    const Eigen::Matrix4d clip_from_world = eye.clip_from_world();
    Eigen::Vector3d at;
    for (double ahead_m = kBeforeTheEyeM + 0.5 * size_m.maxCoeff();; ahead_m += kStepM) {
        at = eye.eye_world() + ahead_m * forward;
        const Eigen::Vector4d foot = clip_from_world * Eigen::Vector4d(at.x(), at.y(), 0.0, 1.0);
        if (ahead_m > kFarthestM || foot.y() > kLowestInView * foot.w()) break;
    }
    at.z() = std::max(at.z(), 0.5 * size_m.z() + kOffTheFloorM);
    return at;
}

// The nearest free place to the left or right of `at`; `at` if there is none in the picture.
Eigen::Vector3d beside_taken(const Eigen::Vector3d& at,
                             const Eigen::Vector3d& size_m,
                             const renderer::EyeView& eye,
                             const std::vector<TakenPlace>& taken) {
    const double radius_m = 0.5 * std::hypot(size_m.x(), size_m.y());
    const auto is_free = [&](const Eigen::Vector3d& place) {
        return std::ranges::none_of(taken, [&](const TakenPlace& other) {
            return (place.head<2>() - other.middle).norm() < radius_m + other.radius_m;
        });
    };
    const Eigen::Vector3d right = eye.view_from_world.row(0).head<3>().transpose();
    const Eigen::Matrix4d clip_from_world = eye.clip_from_world();
    for (int i = 0; i <= 2 * kAsideSteps; ++i) {
        const int steps = (i + 1) / 2;
        const double aside_m = (i % 2 == 0 ? 1.0 : -1.0) * kAsideStepM * steps;
        const Eigen::Vector3d place = at + aside_m * right;
        const Eigen::Vector4d seen = clip_from_world * place.homogeneous();
        if (std::abs(seen.x()) <= kMostAside * seen.w() && is_free(place)) return place;
    }
    return at;
}

// crate, crate_2, crate_3: the first that is free.
std::string free_name(const std::string& name,
                      const std::map<std::uint32_t, bus::SceneObject>& objects) {
    constexpr std::size_t kMaxLength = 63;
    constexpr std::size_t kMostDigits = 3;  // more are a year or a number of a part
    std::string stem = name;
    const std::size_t last = name.find_last_not_of("0123456789");
    if (last != std::string::npos && last > 0 && name[last] == '_') {
        const std::size_t digits = name.size() - last - 1;
        if (digits >= 1 && digits <= kMostDigits) stem.resize(last);
    }
    for (int i = 2;; ++i) {
        const std::string ending = fmt::format("_{}", i);
        std::string wanted = stem.substr(0, kMaxLength - ending.size()) + ending;
        const bool is_free = std::ranges::none_of(
            objects, [&](const auto& there) { return there.second.name == wanted; });
        if (is_free) return wanted;
    }
}

// The name itself if it is free.
std::string unused_name(const std::string& name,
                        const std::map<std::uint32_t, bus::SceneObject>& objects) {
    const bool is_used =
        std::ranges::any_of(objects, [&](const auto& there) { return there.second.name == name; });
    return is_used ? free_name(name, objects) : name;
}

}  // namespace

bus::SceneObject make_object(const NewObject& wanted,
                             const renderer::EyeView& eye,
                             const std::vector<TakenPlace>& taken,
                             const std::map<std::uint32_t, bus::SceneObject>& objects) {
    bus::SceneObject object;
    object.shape = wanted.shape;
    object.name = unused_name(valid_name(wanted.name, wanted.shape), objects);
    object.size_m = size_of(wanted);
    object.mass_kg = std::clamp(wanted.mass_kg, 0.01, 1000.0);
    object.restitution = wanted.shape == bus::Shape::kSphere ? 0.6 : 0.2;
    object.colour = wanted.colour.cwiseMax(0.0).cwiseMin(1.0);
    object.world_from_object.translation =
        beside_taken(place_before(eye, object.size_m), object.size_m, eye, taken);
    return object;
}

bus::SceneObject make_object(const NewModel& wanted,
                             const renderer::EyeView& eye,
                             const std::vector<TakenPlace>& taken,
                             const std::map<std::uint32_t, bus::SceneObject>& objects) {
    const std::size_t begin = wanted.file.find_last_of('/') + 1;  // 0 if there is no folder
    const std::size_t end = wanted.file.find('.', begin);
    bus::SceneObject object;
    object.shape = wanted.is_compound ? bus::Shape::kCompound : bus::Shape::kConvex;
    object.name =
        unused_name(valid_name(wanted.file.substr(begin, end - begin), object.shape), objects);
    object.model = wanted.file;
    object.model_scale = wanted.scale;
    object.colour = wanted.colour.value_or(object.colour);
    object.size_m = (wanted.scale * wanted.size_m).cwiseMax(kMinSizeM);
    object.mass_kg = std::clamp(wanted.mass_kg, 0.0, 1000.0);
    object.world_from_object.translation =
        beside_taken(place_before(eye, object.size_m), object.size_m, eye, taken);
    return object;
}

bus::SceneObject make_copy(const bus::SceneObject& original,
                           const geometry::RigidTransform& pose,
                           const std::map<std::uint32_t, bus::SceneObject>& objects,
                           const renderer::EyeView& eye,
                           std::vector<TakenPlace> taken) {
    constexpr double kGapM = 0.05;
    bus::SceneObject copy = original;
    copy.object = 0;
    copy.name = free_name(original.name, objects);
    copy.world_from_object = pose;
    const Eigen::Vector3d size_m =
        pose.rotation.toRotationMatrix().cwiseAbs() * original.size_m;  // along the world's axes
    const double radius_m = 0.5 * std::hypot(size_m.x(), size_m.y());
    taken.push_back({pose.translation.head<2>(), radius_m});
    Eigen::Vector3d& at = copy.world_from_object.translation;
    at = beside_taken(pose.translation, size_m, eye, taken);
    if (at == pose.translation) {  // no free place in the picture
        const Eigen::Vector3d right = eye.view_from_world.row(0).head<3>().transpose();
        at += (2.0 * radius_m + kGapM) * right;
    }
    return copy;
}

bus::SceneCommand SceneEditor::command(bus::CommandKind kind) const {
    bus::SceneCommand command;
    command.sender = sender_;
    command.kind = kind;
    return command;
}

void SceneEditor::add_pending(PendingCommand pending) {
    if (pending_.size() >= kMaxPendingEdits) pending_.erase(pending_.begin());
    pending_.push_back(std::move(pending));
}

bus::SceneCommand SceneEditor::add(const bus::SceneObject& object,
                                   const Objects& objects,
                                   Clock::time_point now) {
    PendingCommand pending{object.name, now, num_refused_, std::nullopt, {}};
    for (const auto& [id, there] : objects) {
        if (there.name == object.name) pending.before.insert(id);
    }
    add_pending(std::move(pending));
    bus::SceneCommand add = command(bus::CommandKind::kAdd);
    add.object = object;
    return add;
}

bus::SceneCommand SceneEditor::remove(std::uint32_t object,
                                      const Objects& objects,
                                      Clock::time_point now) {
    const auto found = objects.find(object);
    const std::string name = found == objects.end() ? "it" : found->second.name;
    add_pending({name, now, num_refused_, object, {}});
    bus::SceneCommand remove = command(bus::CommandKind::kRemove);
    remove.target = object;
    return remove;
}

bool SceneEditor::took_effect(const PendingCommand& pending, const Objects& objects) {
    if (pending.gone) return !objects.contains(*pending.gone);
    const auto came = std::find_if(objects.begin(), objects.end(), [&](const auto& there) {
        return there.second.name == pending.name && !pending.before.contains(there.first);
    });
    if (came == objects.end()) return false;
    // two requests for one name need two objects
    for (PendingCommand& other : pending_) {
        if (!other.gone && other.name == pending.name) other.before.insert(came->first);
    }
    return true;
}

std::string SceneEditor::reason(const PendingCommand& pending, const Servers& servers) const {
    if (!servers.are_there) return "no world server is running";
    // the server counts refusals without naming the sender
    return servers.num_refused > pending.num_refused ? "the world server refused it"
                                                     : "the world server did not react";
}

std::vector<SceneEditor::Outcome> SceneEditor::outcomes(const Objects& objects,
                                                        const Servers& servers,
                                                        Clock::time_point now) {
    num_refused_ = servers.num_refused;
    std::vector<Outcome> outcomes;
    for (auto pending = pending_.begin(); pending != pending_.end();) {
        const bool is_done = took_effect(*pending, objects);
        if (!is_done && now - pending->since < kPatience) {
            ++pending;
            continue;
        }
        const std::string what = pending->gone ? "removed" : "added";
        outcomes.push_back(
            {is_done
                 ? fmt::format("{} was {}", pending->name, what)
                 : fmt::format("{} was not {}: {}", pending->name, what, reason(*pending, servers)),
             is_done});
        pending = pending_.erase(pending);
    }
    return outcomes;
}

}  // namespace atrium::viewer
