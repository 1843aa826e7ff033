#include "core/status/figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::status {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

bus::SiteStatus judged_site(bus::RigVerdict verdict) {
    bus::SiteStatus status;
    status.coherence = {verdict,
                        0.424,
                        48,
                        {{"south", 0.4, 0.99, 351}, {"north", 2.05, 0.7, 340}},
                        {.camera = 1, .turned_deg = 0.2, .cure = "calibrate refine lab.toml"}};
    return status;
}

TEST(Figures, AlarmOfACameraThatWasMoved) {
    bus::SiteStatus status = judged_site(bus::RigVerdict::kMoved);
    const Figures figures = figures_of(status);
    ASSERT_EQ(figures.alarms.size(), 1u);
    EXPECT_EQ(figures.alarms[0].what, "camera north was moved (turned by 0.20 degrees)");
    EXPECT_EQ(figures.alarms[0].advice, "calibrate refine");
    EXPECT_EQ(figures.alarms[0].cure, "calibrate refine lab.toml");
    EXPECT_EQ(figures.coherence, status.coherence);
    status.coherence.fault.moved_mm = 10.0;
    status.coherence.fault.is_either = true;
    EXPECT_EQ(figures_of(status).alarms[0].what,
              "camera north was moved (turned by 0.20 degrees or moved by 10 mm)");
}

TEST(Figures, AlarmOfACameraThatIsLate) {
    bus::SiteStatus status = judged_site(bus::RigVerdict::kLate);
    status.coherence.fault.late_instants = 1.02;
    EXPECT_EQ(figures_of(status).alarms[0].what, "camera north is late by 1.0 instants");
    EXPECT_EQ(figures_of(status).alarms[0].advice, "check its trigger");
    status.coherence.fault.late_instants = -1.0;
    EXPECT_EQ(figures_of(status).alarms[0].what, "camera north is early by 1.0 instants");
}

TEST(Figures, AlarmOfARigThatNoCameraExplains) {
    bus::SiteStatus status = judged_site(bus::RigVerdict::kIncoherent);
    status.coherence.fault = {.cure = "calibrate refine lab.toml"};
    const Figures figures = figures_of(status);
    ASSERT_EQ(figures.alarms.size(), 1u);
    EXPECT_EQ(figures.alarms[0].what, "the silhouettes contradict the rig by 0.4 px");
    EXPECT_EQ(figures.alarms[0].cure, "calibrate refine lab.toml");
}

TEST(Figures, AlarmOfOtherLenses) {
    bus::SiteStatus status = judged_site(bus::RigVerdict::kLenses);
    status.coherence.fault = {.cure = "calibrate refine lab.toml --focal"};
    const Figures figures = figures_of(status);
    ASSERT_EQ(figures.alarms.size(), 1u);
    EXPECT_EQ(figures.alarms[0].what,
              "the cameras have other lenses than the rig says (zoom, crop, stabilisation)");
    EXPECT_EQ(figures.alarms[0].advice, "calibrate refine --focal");
    EXPECT_EQ(figures.alarms[0].cure, "calibrate refine lab.toml --focal");
    EXPECT_EQ(rig_items(status.coherence).front(), "lenses");
}

TEST(Figures, AlarmOfWhatTheSiteFound) {
    bus::SiteStatus status;
    status.finding = "door and desk look swapped: exchange their pictures: folders or cables";
    const Figures figures = figures_of(status);
    ASSERT_EQ(figures.alarms.size(), 1u);
    EXPECT_EQ(figures.alarms[0].what, "door and desk look swapped");
    EXPECT_EQ(figures.alarms[0].cure, status.finding);
    status.finding = "no colon";
    EXPECT_EQ(figures_of(status).alarms[0].what, "no colon");
}

TEST(Figures, NoAlarmOfARigThatIsTrueOrUnknown) {
    for (const auto verdict : {bus::RigVerdict::kUnknown, bus::RigVerdict::kCoherent})
        EXPECT_THAT(figures_of(judged_site(verdict)).alarms, IsEmpty());
    EXPECT_FALSE(figures_of(bus::WorldStatus{}).coherence);
}

TEST(RigItems, SayHowTrueTheRigIs) {
    EXPECT_THAT(rig_items(judged_site(bus::RigVerdict::kCoherent).coherence),
                ElementsAre("coherent", "0.42 px", "worst north 2.05 px", "48 instants"));
    EXPECT_THAT(rig_items(judged_site(bus::RigVerdict::kUnknown).coherence), IsEmpty());
    EXPECT_THAT(rig_items({}), IsEmpty());
}

}  // namespace
}  // namespace atrium::status
