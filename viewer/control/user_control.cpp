#include "viewer/control/user_control.hpp"

#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {
namespace {

bool moves(const Motion& motion) {
    return !motion.turn_px.isZero() || !motion.pan_px.isZero() || !motion.fly.isZero() ||
           motion.zoom_steps != 0.0 || motion.walk;
}

}  // namespace

void UserControl::fly_to(const renderer::ViewCamera& camera, Clock::time_point now) {
    if (is_fixed_) return;
    has_moved_ = true;
    follow_.leave();
    flight_.start(camera_, camera, now);
}

void UserControl::set_start(const renderer::ViewCamera& start) {
    if (is_fixed_) return;
    start_ = start;
    if (!has_moved_) camera_ = start;
}

namespace {

void add_to(WorldEditing::Edits& all, WorldEditing::Edits more) {
    std::move(more.begin(), more.end(), std::back_inserter(all));
}

std::vector<Eigen::Vector3d> movable_things(const UserControl::Shown& shown) {
    std::vector<Eigen::Vector3d> places;
    for (const bus::ObjectState& state : shown.states) {
        const auto object = shown.objects.find(state.object);
        if (object != shown.objects.end() && object->second.mass_kg > 0.0)
            places.push_back(state.world_from_object.translation);
    }
    return places;
}

}  // namespace

WorldEditing::Shown UserControl::edit_shown(const Shown& shown) {
    return {shown.pointer, shown.eye, shown.pick_all, shown.objects, shown.states};
}

void UserControl::remove(std::uint32_t object,
                         const Shown& shown,
                         Clock::time_point now,
                         Commands& out) {
    if (editing_.is_supported())
        add_to(edits_, editing_.remove(object, edit_shown(shown), now));
    else {
        out.push_back(editor_.remove(object, shown.objects, now));
        editing_.expect_removal(object);
    }
}

UserControl::Commands UserControl::move(const SurfaceEvents& events,
                                        const Shown& shown,
                                        Clock::time_point now) {
    if (is_fixed_) return {};
    add_to(edits_, editing_.update(events.edit, edit_shown(shown), now));
    Pointer pointer = shown.pointer;
    Motion motion = events.motion;
    if (editing_.has_pointer()) {
        pointer.is_down = false;
        motion.turn_px.setZero();
    }
    Commands commands = mouse_.update(pointer, camera_, shown.pick, now);
    if (mouse_.is_holding()) motion.turn_px.setZero();  // the drag moves the object
    if (events.follow) {
        if (shown.visible.empty())
            texts_.emplace_back(shown.people.empty() ? "nobody is here to follow"
                                                     : "nobody to follow: all are hidden (L)");
        follow_.toggle_follow(camera_, shown.visible);
    }
    if (events.person > shown.people.size())
        texts_.push_back("no person " + std::to_string(events.person));
    else if (events.person > 0)
        follow_.toggle_first_person(events.person, shown.people, movable_things(shown));
    if (events.leave_eyes) follow_.leave_eyes();
    if (events.stop_following) follow_.leave();
    if (events.reset_view) follow_.leave();
    const bool is_moving = events.follow || events.person > 0 || moves(motion);
    if (is_moving || events.reset_view) flight_.stop();
    has_moved_ = is_moving || (has_moved_ && !events.reset_view);
    if (follow_.is_first_person()) {
        motion.look_around = true;
        motion.walk = false;
        motion.fly.setZero();
        motion.pan_px.setZero();
        motion.zoom_steps = 0.0;
    }
    camera_ = events.reset_view ? start_ : apply(motion, camera_);
    camera_ = flight_.update(camera_, now);
    camera_ = follow_.update(camera_, shown.people, now);
    return commands;
}

namespace {

// What people and objects cover of the floor. What lies flat in it covers nothing.
std::vector<TakenPlace> taken_places(const UserControl::Shown& shown) {
    constexpr double kFlatM = 0.05;
    std::vector<TakenPlace> taken;
    for (const auto& [name, person] : shown.people)
        taken.push_back({person.middle.head<2>(), 0.5 * person.size.head<2>().norm()});
    std::map<std::uint32_t, Eigen::Vector3d> places;
    for (const bus::ObjectState& state : shown.states)
        places[state.object] = state.world_from_object.translation;
    for (const auto& [id, object] : shown.objects) {
        const auto moved = places.find(id);
        const Eigen::Vector3d& at =
            moved == places.end() ? object.world_from_object.translation : moved->second;
        if (object.shape == bus::Shape::kPlane || at.z() + 0.5 * object.size_m.z() < kFlatM)
            continue;
        taken.push_back({at.head<2>(), 0.5 * object.size_m.head<2>().norm()});
    }
    return taken;
}

}  // namespace

UserControl::Commands UserControl::edit(const SurfaceEvents& events,
                                        const Shown& shown,
                                        const renderer::EyeView& eye,
                                        Clock::time_point now) {
    Commands commands;
    if (events.reset_scene) commands.push_back(editor_.reset());
    if (events.add) {
        const bus::SceneObject object =
            make_object(*events.add, eye, taken_places(shown), shown.objects);
        if (editing_.is_supported())
            add_to(edits_, editing_.add(object, now));
        else
            commands.push_back(editor_.add(object, shown.objects, now));
    }
    // an older world server does not react, which the history reports
    if (events.edit.add_model)
        add_to(
            edits_,
            editing_.add(
                make_object(*events.edit.add_model, eye, taken_places(shown), shown.objects), now));
    if (events.edit.duplicate)
        add_to(edits_, editing_.duplicate(edit_shown(shown), taken_places(shown), now));
    if (events.remove) remove(*events.remove, shown, now, commands);
    if (events.remove_pointed && !is_fixed_) {
        const auto hit =
            events.is_over_panel ? std::nullopt : shown.pick(ray_through(camera_, shown.pointer));
        const std::uint32_t pointed = hit ? hit->object : 0;
        const bool is_selected = shown.objects.contains(editing_.selected());
        const std::uint32_t object = is_selected ? editing_.selected() : pointed;
        if (object != 0)
            remove(object, shown, now, commands);
        else
            texts_.emplace_back("nothing to remove here: select an object, or point at one");
    }
    return commands;
}

}  // namespace atrium::viewer
