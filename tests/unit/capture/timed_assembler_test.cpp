#include "site_node/capture/timed_assembler.hpp"

#include <gtest/gtest.h>

#include <future>

namespace atrium::capture {
namespace {

using std::chrono::milliseconds;

CameraFrame picture_at(std::size_t camera, std::int64_t time_ns) {
    static const auto picture = std::make_shared<const image::YuvImage>(
        image::YuvImage{image::Plane(2, 2), image::Plane(1, 1), image::Plane(1, 1)});
    CameraFrame f;
    f.camera = camera;
    f.capture_time = {time_ns};
    f.image = picture;
    return f;
}

TEST(TimedAssembler, EndsAMetaframeAtItsDeadlineWithoutAnotherPicture) {
    std::promise<Metaframe> ended;
    TimedAssembler assembler(3,
                             {milliseconds(1), milliseconds(20), 2},
                             [&](std::optional<Metaframe> metaframe, const MetaframeAssembler&) {
                                 if (metaframe) ended.set_value(std::move(*metaframe));
                             });
    assembler.add(picture_at(0, 1000));
    assembler.add(picture_at(2, 1000));
    const Metaframe metaframe = ended.get_future().get();
    EXPECT_TRUE(metaframe.frames[1].image.empty());
}

TEST(TimedAssembler, DropsAMetaframeWithTooFewCamerasAtItsDeadline) {
    std::promise<void> dropped;
    TimedAssembler assembler(
        2,
        {milliseconds(1), milliseconds(20)},
        [&](const std::optional<Metaframe>& metaframe, const MetaframeAssembler& source) {
            EXPECT_FALSE(metaframe);
            if (source.counters().num_incomplete == 1) dropped.set_value();
        });
    assembler.add(picture_at(0, 1000));
    dropped.get_future().get();
}

TEST(TimedAssembler, EndsAtOnceWhileAMetaframeIsPending) {
    bool is_called_with_metaframe = false;
    {
        TimedAssembler assembler(
            2,
            {milliseconds(1), std::chrono::hours(1)},
            [&](std::optional<Metaframe> metaframe, const MetaframeAssembler&) {
                if (metaframe) is_called_with_metaframe = true;
            });
        assembler.add(picture_at(0, 1000));
    }
    EXPECT_FALSE(is_called_with_metaframe);
}

}  // namespace
}  // namespace atrium::capture
