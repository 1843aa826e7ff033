#include "viewer/control/world_editing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

// What the user reads when the selected object vanishes.
namespace atrium::viewer {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

class SelectedObject : public testing::Test {
protected:
    SelectedObject() {
        for (const std::uint32_t id : {3u, 4u}) {
            objects_[id].object = id;
            objects_[id].name = id == 3u ? "ball" : "crate";
        }
        EditNews news;
        news.saved_worlds.emplace();
        editing_.take(std::move(news), now_);
        EditEvents select;
        select.select = 3u;
        update(select);
    }
    void update(const EditEvents& events = {}) {
        const auto none = [](const Ray&) { return std::optional<Hit>(); };
        editing_.update(events, {{}, {}, none, objects_, states_}, now_);
    }
    // What is said in the next second.
    std::vector<std::string> texts() {
        std::vector<std::string> all;
        for (int i = 0; i < 10; ++i) {
            now_ += 100ms;
            update();
            for (std::string& text : editing_.take({}, now_)) all.push_back(std::move(text));
        }
        return all;
    }
    void hear(const std::string& sender, std::uint32_t object) {
        EditNews news;
        bus::EditResult& result = news.of_others.emplace_back();
        result.sender = sender;
        result.object = object;
        result.is_done = true;
        editing_.take(std::move(news), now_);
    }

    SceneEditor::Objects objects_;
    std::vector<bus::ObjectState> states_;
    WorldEditing::Clock::time_point now_{1h};
    WorldEditing editing_{"eve"};
};

TEST_F(SelectedObject, IsSaidToBeRemovedByWhom) {
    EXPECT_THAT(texts(), IsEmpty());
    objects_.erase(3);
    hear("bob", 3);
    EXPECT_THAT(texts(), ElementsAre("ball was removed by bob"));
    EXPECT_THAT(texts(), IsEmpty()) << "once";
    EXPECT_EQ(editing_.selected(), 0U);
}

TEST_F(SelectedObject, IsSaidToBeRemovedWithoutANameThatIsUnknown) {
    hear("bob", 3);  // he moved it
    texts();
    texts();
    objects_.erase(3);
    EXPECT_THAT(texts(), ElementsAre("ball was removed"));
}

TEST_F(SelectedObject, SaysNothingMoreIfThisViewerRemovesIt) {
    const auto none = [](const Ray&) { return std::optional<Hit>(); };
    const auto edits = editing_.remove(3, {{}, {}, none, objects_, states_}, now_);
    ASSERT_EQ(edits.size(), 1U);
    objects_.erase(3);
    EditNews news;
    bus::EditResult& result = news.results.emplace_back();
    result.number = edits[0].number;
    result.object = 3;
    result.is_done = true;
    EXPECT_THAT(editing_.take(std::move(news), now_), ElementsAre("ball was removed"));
    EXPECT_THAT(texts(), IsEmpty());
}

TEST_F(SelectedObject, SaysNothingIfTheWorldServerIsGone) {
    objects_.clear();
    EXPECT_THAT(texts(), IsEmpty());
}

}  // namespace
}  // namespace atrium::viewer
