#include "viewer/control/user_control.hpp"

namespace atrium::viewer {
namespace {

bool moves(const Motion& motion) {
    return !motion.turn_px.isZero() || !motion.pan_px.isZero() || !motion.fly.isZero() ||
           motion.zoom_steps != 0.0 || motion.walk;
}

}  // namespace

void UserControl::fly_to(const renderer::ViewCamera& camera, Clock::time_point now) {
    if (is_fixed_) return;
    follow_.leave();
    flight_.start(camera_, camera, now);
}

UserControl::Commands UserControl::move(const SurfaceEvents& events,
                                        const Shown& shown,
                                        Clock::time_point now) {
    if (is_fixed_) return {};
    Commands commands = mouse_.update(shown.pointer, camera_, shown.pick, now);
    Motion motion = events.motion;
    if (mouse_.is_holding()) motion.turn_px.setZero();  // the drag moves the object
    if (events.follow) follow_.toggle_follow(camera_, shown.people);
    if (events.person > 0) follow_.toggle_first_person(events.person, shown.people);
    if (events.reset_view) follow_.leave();
    if (events.follow || events.person > 0 || events.reset_view || moves(motion)) flight_.stop();
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

UserControl::Commands UserControl::edit(const SurfaceEvents& events,
                                        const Shown& shown,
                                        const renderer::EyeView& eye,
                                        Clock::time_point now) {
    Commands commands;
    if (events.reset_scene) commands.push_back(editor_.reset());
    if (events.add)
        commands.push_back(editor_.add(make_object(*events.add, eye), shown.objects, now));
    if (events.remove) commands.push_back(editor_.remove(*events.remove, shown.objects, now));
    if (events.remove_pointed && !is_fixed_) {
        if (const auto hit = shown.pick(ray_through(camera_, shown.pointer)))
            commands.push_back(editor_.remove(hit->object, shown.objects, now));
    }
    return commands;
}

}  // namespace atrium::viewer
