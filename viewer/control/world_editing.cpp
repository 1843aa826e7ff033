#include "viewer/control/world_editing.hpp"

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr double kClickPx = 4.0;          // a press that moves further is a drag
constexpr double kClickHeightPx = 720.0;  // of the picture; more in a higher one
constexpr std::chrono::milliseconds kHoldPeriod{15};
constexpr std::chrono::milliseconds kHoldSignOfLife{500};
constexpr std::chrono::milliseconds kNameComes{300};  // the result of an edit, after its effect
constexpr std::chrono::seconds kNameValid{1};         // or before it
constexpr std::size_t kMaxEditors = 256;

bool is_same(const geometry::RigidTransform& a, const geometry::RigidTransform& b) {
    return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
}

}  // namespace

std::optional<EditHistory::Object> WorldEditing::object_of(std::uint32_t id,
                                                           const Shown& shown) const {
    const auto found = shown.objects.find(id);
    if (id == 0 || found == shown.objects.end()) return std::nullopt;
    EditHistory::Object object{found->second, found->second.world_from_object};
    for (const bus::ObjectState& state : shown.states) {
        if (state.object == id) object.pose = state.world_from_object;
    }
    return object;
}

EditHandles WorldEditing::handles_of(const EditHistory::Object& object) const {
    EditHandles handles;
    handles.mode = mode_;
    handles.is_local = is_local_;
    handles.world_from_object = drag_ ? goal_ : object.pose;
    return handles;
}

WorldEditing::Edits WorldEditing::update(const EditEvents& events,
                                         const Shown& shown,
                                         Clock::time_point now) {
    Edits out;
    if (!events.is_enabled) {
        if (drag_) cancel(out);
        selected_ = 0;
        return out;
    }
    if (const std::uint32_t added = history_.take_added(); added != 0) selected_ = added;
    if (selected_ != 0 && !shown.objects.contains(selected_) && !drag_) hovered_.reset();
    tell_removed(shown, now);
    if (std::exchange(lets_go_, false))
        out.push_back(history_.edit(bus::EditKind::kLetGo, dragged_.object.object));
    take_keys(events, shown, now, out);
    const bool is_pressed = shown.pointer.is_down && !was_down_;
    if (!shown.pointer.is_down && !was_down_) owns_press_ = false;
    const bool is_released = !shown.pointer.is_down && was_down_;
    was_down_ = shown.pointer.is_down;
    if (is_pressed) press(shown, now);
    const double least_drag_px = kClickPx * std::max(1.0, shown.pointer.height_px / kClickHeightPx);
    if ((shown.pointer.at_px - pressed_px_).norm() > least_drag_px) {
        is_click_ = false;
        is_pull_ = is_pull_ || shown.pointer.is_down;
    }
    if (is_pull_ && !refused_pull_.empty()) texts_.push_back(std::exchange(refused_pull_, {}));
    if (drag_)
        drag(events, shown, now, out);
    else if (is_released && std::exchange(is_click_, false))
        select_by_click(shown);
    const auto object = object_of(selected_, shown);
    if (!drag_ && !shown.pointer.is_down) {
        hovered_ = object && object->object.shape != bus::Shape::kSoft
                       ? handles_of(*object).pick(shown.pointer, shown.eye)
                       : std::nullopt;
    }
    if (auto wanted = history_.next(now, texts_)) out.push_back(std::move(*wanted));
    return out;
}

void WorldEditing::take_keys(const EditEvents& events,
                             const Shown& shown,
                             Clock::time_point now,
                             Edits& out) {
    if (events.select) selected_ = *events.select;
    const bool has_selected = object_of(selected_, shown).has_value();
    if (events.next_handles && !has_selected)
        texts_.emplace_back("J switches the handles of the selected object: click one");
    else if (events.next_handles && !drag_)
        mode_ = mode_ == HandleMode::kMove ? HandleMode::kRotate : HandleMode::kMove;
    if (events.local_axes && !has_selected)
        texts_.emplace_back("C switches the axes of the selected object: click one");
    else if (events.local_axes && !drag_)
        is_local_ = !is_local_;
    if (events.axis && drag_) drag_->constrain(*events.axis, shown.pointer, shown.eye);
    if (events.undo && !drag_) history_.want_undo();
    if (events.redo && !drag_) history_.want_redo();
    if (events.cancel) {
        if (drag_)
            cancel(out);
        else
            selected_ = 0;
    }
    if (events.change) {
        if (const auto before = object_of(events.change->object, shown))
            out.push_back(history_.change(*before, *events.change, now));
    }
    if (events.place && !drag_)
        place(*events.place, shown, now, out);
    else if (std::exchange(is_held_by_field_, false))
        out.push_back(history_.edit(bus::EditKind::kLetGo, dragged_.object.object));
    if (!events.save_world.empty()) out.push_back(history_.save_world(events.save_world, now));
    if (events.load_world.empty()) return;
    out.push_back(history_.load_world(events.load_world, now));
    selected_ = 0;  // another object may get its number
}

void WorldEditing::press(const Shown& shown, Clock::time_point now) {
    is_click_ = true;
    is_pull_ = false;
    refused_pull_.clear();
    pressed_px_ = shown.pointer.at_px;
    const auto object = object_of(selected_, shown);
    if (!object || object->object.shape == bus::Shape::kSoft) return;
    const EditHandles handles = handles_of(*object);
    const auto handle = handles.pick(shown.pointer, shown.eye);
    if (!handle) return;
    if (!is_supported()) {
        texts_.emplace_back("the world server does not know edits: it cannot be moved by handles");
        return;
    }
    is_click_ = false;
    owns_press_ = true;
    dragged_ = *object;
    goal_ = sent_ = object->pose;
    drag_.emplace(handles, *handle, shown.pointer, shown.eye);
    hovered_ = handle;
    sent_at_ = now - kHoldSignOfLife;
}

void WorldEditing::drag(const EditEvents& events,
                        const Shown& shown,
                        Clock::time_point now,
                        Edits& out) {
    if (!shown.objects.contains(dragged_.object.object)) {
        drag_.reset();  // `tell_removed` says so
        return;
    }
    if (!shown.pointer.is_down) {
        const bool has_moved = !is_same(goal_, dragged_.pose);
        drag_.reset();
        if (has_moved)
            out.push_back(history_.place(dragged_, goal_, now));
        else
            out.push_back(history_.edit(bus::EditKind::kLetGo, dragged_.object.object));
        return;
    }
    goal_ = drag_->update(shown.pointer, shown.eye, events.snaps);
    hovered_ = drag_->handle();
    hold_at_goal(now, out);
}

// Tells the others where the dragged object is.
void WorldEditing::hold_at_goal(Clock::time_point now, Edits& out) {
    const bool is_news = !is_same(goal_, sent_) && now - sent_at_ >= kHoldPeriod;
    if (!is_news && now - sent_at_ < kHoldSignOfLife) return;
    bus::SceneEdit hold = history_.edit(bus::EditKind::kHold, dragged_.object.object);
    hold.world_from_object = goal_;
    out.push_back(std::move(hold));
    sent_ = goal_;
    sent_at_ = now;
}

void WorldEditing::place(const PlaceWanted& wanted,
                         const Shown& shown,
                         Clock::time_point now,
                         Edits& out) {
    const auto object = object_of(wanted.object, shown);
    if (!object) {
        is_held_by_field_ = false;
        return;
    }
    if (!is_held_by_field_) {
        dragged_ = *object;
        sent_ = object->pose;
        sent_at_ = now - kHoldSignOfLife;
    }
    goal_ = wanted.world_from_object;
    is_held_by_field_ = wanted.is_held;
    if (is_held_by_field_)
        hold_at_goal(now, out);
    else
        out.push_back(history_.place(dragged_, goal_, now));
}

// Puts the object back to where the drag began. Its start stays as it was.
void WorldEditing::cancel(Edits& out) {
    const std::uint32_t id = dragged_.object.object;
    bus::SceneEdit back = history_.edit(bus::EditKind::kPlace, id);
    back.object = dragged_.object;
    back.world_from_object = dragged_.pose;
    out.push_back(std::move(back));
    drag_.reset();
    is_click_ = false;
}

void WorldEditing::select_by_click(const Shown& shown) {
    const auto hit = shown.pick(ray_of(shown.pointer.at_px, shown.eye));
    selected_ = hit ? hit->object : 0;
}

WorldEditing::Edits WorldEditing::add(const bus::SceneObject& object, Clock::time_point now) {
    return {history_.add(object, now)};
}

WorldEditing::Edits WorldEditing::duplicate(const Shown& shown,
                                            const std::vector<TakenPlace>& taken,
                                            Clock::time_point now) {
    const auto original = object_of(selected_, shown);
    const auto refuse = [&](std::string why) -> Edits {
        texts_.push_back(std::move(why));
        return {};
    };
    if (!original) return refuse("Ctrl+D duplicates the selected object: click one");
    const std::string& name = original->object.name;
    if (!is_supported())
        return refuse(name + " was not duplicated: the world server does not know edits");
    if (original->object.shape == bus::Shape::kSoft)
        return refuse(name + " is soft: it cannot be duplicated, only described in the world file");
    if (drag_) return refuse(name + " was not duplicated: let go of its handle first");
    if (history_.is_adding())
        return refuse(name + " was not duplicated: the last new object is still on its way");
    return add(make_copy(original->object, original->pose, shown.objects, shown.eye, taken), now);
}

WorldEditing::Edits WorldEditing::remove(std::uint32_t object,
                                         const Shown& shown,
                                         Clock::time_point now) {
    const auto removed = object_of(object, shown);
    if (!removed) return {};
    return {history_.remove(*removed, now)};
}

// Tells that the selected object was removed, and by whom. Whoever removed it knows; without any
// object the world server is gone, which the panel says.
void WorldEditing::tell_removed(const Shown& shown, Clock::time_point now) {
    if (const auto found = shown.objects.find(selected_); found != shown.objects.end()) {
        seen_ = selected_;
        selected_name_ = found->second.name;
        gone_since_.reset();
        return;
    }
    if (selected_ == 0 || seen_ != selected_ || drag_ || shown.objects.empty()) {
        gone_since_.reset();
        return;
    }
    if (!gone_since_) gone_since_ = now;
    const auto editor = editors_.find(selected_);
    const bool has_name =
        editor != editors_.end() && editor->second.at + kNameValid >= *gone_since_;
    if (!has_name && now - *gone_since_ < kNameComes) return;
    if (!history_.has_removed(selected_) && commanded_ != selected_)
        texts_.push_back(selected_name_ + " was removed" +
                         (has_name ? " by " + editor->second.name : ""));
    gone_since_.reset();
    selected_ = seen_ = 0;
}

void WorldEditing::take_others(const std::vector<bus::EditResult>& results, Clock::time_point now) {
    for (const bus::EditResult& result : results) {
        if (editors_.size() >= kMaxEditors && !editors_.contains(result.object))
            editors_.erase(editors_.begin());
        editors_[result.object] = {result.sender, now};
    }
}

// A click that selects also takes hold of the object for a moment: only a drag is told that it may
// not pull.
void WorldEditing::take_refused_pulls(std::vector<bus::EditResult>& results) {
    std::erase_if(results, [this](const bus::EditResult& result) {
        const bool is_pull = result.number == 0 && result.object != 0 && !result.is_done;
        if (is_pull) refused_pull_ = result.text;
        return is_pull;
    });
}

std::vector<std::string> WorldEditing::take(EditNews news, Clock::time_point now) {
    if (news.is_server_gone) worlds_.reset();
    if (news.saved_worlds)
        worlds_ = std::make_shared<const bus::SavedWorlds>(std::move(*news.saved_worlds));
    take_others(news.of_others, now);
    for (const bus::EditResult& result : news.results)
        if (result.is_done) editors_.erase(result.object);  // this viewer is the last
    take_refused_pulls(news.results);
    // the server refused the hold
    const bool was_hold_refused =
        drag_ && std::any_of(news.results.begin(), news.results.end(), [&](const auto& result) {
            return !result.is_done && result.object == dragged_.object.object;
        });
    std::vector<std::string> texts = history_.take(news.results, is_supported(), now);
    if (was_hold_refused) {
        drag_.reset();
        lets_go_ = true;
    }
    texts.insert(texts.end(), texts_.begin(), texts_.end());
    texts_.clear();
    return texts;
}

EditView WorldEditing::view(const Shown& shown) const {
    EditView view;
    view.is_supported = is_supported();
    view.worlds = worlds_;
    if (const auto* step = history_.undo_step()) view.undo = step->name;
    if (const auto* step = history_.redo_step()) view.redo = step->name;
    const auto object = object_of(selected_, shown);
    if (!object) return view;
    view.selected = object->object;
    view.pose = object->pose;
    view.handles = handles_of(*object);
    view.active = hovered_;
    view.is_dragging = drag_.has_value();
    if (drag_) view.readout = drag_->readout();
    return view;
}

}  // namespace atrium::viewer
