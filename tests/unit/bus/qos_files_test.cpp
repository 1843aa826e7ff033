#include "core/base/text_file.hpp"
#include "core/bus/builtin_files.hpp"
#include "core/bus/network_file.hpp"
#include "core/bus/qos_profiles.hpp"
#include "core/bus/topics.hpp"
#include "tests/support/source_dir.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace atrium::bus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string profile_with(const std::string& policies) {
    return "<dds><qos_library name='l'><qos_profile name='p'><datawriter_qos>" + policies +
           "</datawriter_qos></qos_profile></qos_library></dds>";
}

/// A profile with these policies for its writer and its reader.
std::string pair_of(const std::string& writer, const std::string& reader) {
    return "<dds><qos_library><qos_profile name='p'><datawriter_qos>" + writer +
           "</datawriter_qos><datareader_qos>" + reader +
           "</datareader_qos></qos_profile></qos_library></dds>";
}

std::string seconds(const std::string& policy, const std::string& element, int number) {
    return "<" + policy + "><" + element + "><sec>" + std::to_string(number) + "</sec></" +
           element + "></" + policy + ">";
}

std::string error_of(const std::string& xml) {
    const auto profiles = parse_qos_profiles(xml, "here.xml");
    if (profiles) return "no error";
    EXPECT_EQ(profiles.error().kind, ErrorKind::kConfiguration);
    return profiles.error().message;
}

TEST(QosProfiles, BuiltInCopiesEqualTheFiles) {
    const auto profiles = read_text_file(atrium::test::source_dir() + "/qos/profiles.xml");
    ASSERT_TRUE(profiles);
    EXPECT_EQ(*profiles, kBuiltinProfiles);
    for (const BuiltinNetwork& network : kBuiltinNetworks) {
        const auto file = read_text_file(atrium::test::source_dir() + "/qos/" +
                                         std::string(network.kind) + ".xml");
        ASSERT_TRUE(file) << network.kind;
        EXPECT_EQ(*file, network.xml) << network.kind;
    }
}

TEST(QosProfiles, MatchTheDesign) {
    const auto profiles = load_qos_profiles({});
    ASSERT_TRUE(profiles.has_value()) << profiles.error().message;
    ASSERT_EQ(profiles->size(), kProfileNames.size());
    for (const auto name : kProfileNames) {
        ASSERT_TRUE(profiles->contains(name)) << name;
        const QosProfile& profile = profiles->find(name)->second;
        for (const EndpointQos& qos : {profile.writer, profile.reader}) {
            EXPECT_TRUE(qos.reliable);
            EXPECT_EQ(qos.history.keep_all, name == kCommand);
            EXPECT_EQ(qos.transient_local, name == kDescription);
            EXPECT_NE(qos.limits.max_samples, kUnlimited) << "memory is not bounded";
            EXPECT_NE(qos.limits.max_instances, kUnlimited);
            EXPECT_EQ(qos.lease, std::chrono::seconds(1)) << "a lost site must be gone within 2 s";
        }
        EXPECT_EQ(profile.writer.lifespan == kForever, name == kDescription)
            << "only descriptions must live for ever";
        const bool can_be_repaired = name == kStream || name == kTexture;
        for (const EndpointQos& qos : {profile.writer, profile.reader})
            EXPECT_EQ(qos.history.depth, can_be_repaired ? 8 : 1);
        // a full reader takes no further sample of any key
        if (name != kCommand) {
            EXPECT_GE(profile.reader.limits.max_samples,
                      profile.reader.history.depth * profile.writer.limits.max_instances);
            EXPECT_GE(profile.writer.limits.max_samples,
                      profile.writer.history.depth * profile.writer.limits.max_instances);
        }
    }
}

TEST(QosProfiles, ReadsEveryPolicy) {
    const auto profiles = parse_qos_profiles(
        pair_of("<reliability><kind>RELIABLE_RELIABILITY_QOS</kind><max_blocking_time>"
                "<sec>1</sec><nanosec>5</nanosec></max_blocking_time></reliability>"
                "<durability><kind>TRANSIENT_LOCAL_DURABILITY_QOS</kind></durability>"
                "<durability_service><history_kind>KEEP_LAST_HISTORY_QOS</history_kind>"
                "<history_depth>3</history_depth><max_samples>7</max_samples>"
                "</durability_service>"
                "<history><kind>KEEP_LAST_HISTORY_QOS</kind><depth>4</depth></history>"
                "<resource_limits><max_samples>LENGTH_UNLIMITED</max_samples>"
                "<max_instances>9</max_instances></resource_limits>"
                "<deadline><period><sec>1</sec><nanosec>5</nanosec></period></deadline>"
                "<latency_budget><duration><sec>2</sec></duration></latency_budget>"
                "<lifespan><duration><nanosec>7</nanosec></duration></lifespan>"
                "<liveliness><lease_duration><sec>DURATION_INFINITE_SEC</sec>"
                "</lease_duration></liveliness>",
                "<latency_budget><duration><sec>3</sec></duration></latency_budget>"),
        "here.xml");
    ASSERT_TRUE(profiles.has_value()) << profiles.error().message;
    const EndpointQos& qos = profiles->at("p").writer;
    EXPECT_TRUE(qos.reliable);
    EXPECT_EQ(qos.max_blocking_time.count(), 1'000'000'005);
    EXPECT_TRUE(qos.transient_local);
    EXPECT_EQ(qos.late_joiner_history.depth, 3);
    EXPECT_EQ(qos.late_joiner_limits.max_samples, 7);
    EXPECT_EQ(qos.history.depth, 4);
    EXPECT_EQ(qos.limits.max_samples, kUnlimited);
    EXPECT_EQ(qos.limits.max_instances, 9);
    EXPECT_EQ(qos.lease, kForever);
    EXPECT_EQ(qos.deadline.count(), 1'000'000'005);
    EXPECT_EQ(qos.latency_budget.count(), 2'000'000'000);
    EXPECT_EQ(qos.lifespan.count(), 7);
}

TEST(QosProfiles, NameAReaderThatRequestsMoreThanItsWriterOffers) {
    const std::string reliable = "<reliability><kind>RELIABLE_RELIABILITY_QOS</kind></reliability>";
    const std::string kept = "<durability><kind>TRANSIENT_LOCAL_DURABILITY_QOS</kind></durability>";
    struct Case {
        std::string more;
        std::string less;
        std::string name;
    };
    const Case cases[] = {
        {reliable, "", "reliability"},
        {kept, "", "durability"},
        {seconds("deadline", "period", 1), seconds("deadline", "period", 2), "deadline"},
        {seconds("liveliness", "lease_duration", 1),
         seconds("liveliness", "lease_duration", 2),
         "liveliness"},
        {seconds("latency_budget", "duration", 1),
         seconds("latency_budget", "duration", 2),
         "latency_budget"},
    };
    for (const Case& c : cases) {
        EXPECT_THAT(error_of(pair_of(c.less, c.more)),
                    AllOf(HasSubstr("here.xml"),
                          HasSubstr("'p'"),
                          HasSubstr("<datawriter_qos> <" + c.name + ">"),
                          HasSubstr("<datareader_qos> <" + c.name + ">")));
        EXPECT_EQ(error_of(pair_of(c.more, c.less)), "no error") << c.name;
        EXPECT_EQ(error_of(pair_of(c.more, c.more)), "no error") << c.name;
    }
}

TEST(QosProfiles, NameUnknownElements) {
    EXPECT_THAT(error_of(profile_with("<ownership/>")),
                AllOf(HasSubstr("here.xml"),
                      HasSubstr("'p'"),
                      HasSubstr("<ownership>"),
                      HasSubstr("<reliability>")));
    EXPECT_THAT(error_of(profile_with("<deadline/>")), HasSubstr("<period>"));
    EXPECT_THAT(error_of(profile_with("<deadline><duration/></deadline>")),
                AllOf(HasSubstr("<duration>"), HasSubstr("<period>")));
    EXPECT_THAT(error_of(profile_with("<history/><history/>")), HasSubstr("twice"));
    EXPECT_THAT(error_of(pair_of("", "<lifespan/>")),
                AllOf(HasSubstr("<lifespan>"), HasSubstr("<datareader_qos>")));
    EXPECT_THAT(error_of(profile_with("<history><kind>KEEP_SOME</kind></history>")),
                AllOf(HasSubstr("KEEP_SOME"), HasSubstr("KEEP_ALL_HISTORY_QOS")));
    EXPECT_THAT(error_of(profile_with("<history><depth>0</depth></history>")),
                AllOf(HasSubstr("<depth>"), HasSubstr("'0'")));
    EXPECT_THAT(error_of(profile_with("<history><depth>1x</depth></history>")), HasSubstr("1x"));
    EXPECT_THAT(error_of(profile_with("<history><deep>1</deep></history>")), HasSubstr("<deep>"));
    EXPECT_THAT(
        error_of(profile_with("<durability><kind>PERSISTENT_DURABILITY_QOS</kind></durability>")),
        HasSubstr("PERSISTENT"));
    EXPECT_THAT(error_of(profile_with(
                    "<liveliness><kind>MANUAL_BY_TOPIC_LIVELINESS_QOS</kind></liveliness>")),
                HasSubstr("MANUAL"));
    EXPECT_THAT(error_of(profile_with("<history><depth>2</depth></history><resource_limits>"
                                      "<max_samples_per_instance>1</max_samples_per_instance>"
                                      "</resource_limits>")),
                HasSubstr("depth"));
    EXPECT_THAT(error_of("<dds><qos_profile name='q'/></dds>"), HasSubstr("<qos_profile>"));
    EXPECT_THAT(
        error_of("<dds><qos_library><qos_profile name='q' base_name='p'/></qos_library></dds>"),
        HasSubstr("base_name"));
    EXPECT_THAT(error_of("<dds><qos_library><qos_profile/></qos_library></dds>"),
                HasSubstr("name"));
    EXPECT_THAT(error_of("<qos/>"), HasSubstr("<dds>"));
    EXPECT_THAT(error_of("<dds><qos_lib"), HasSubstr(":1: not valid XML"));
    EXPECT_THAT(error_of(""), HasSubstr("here.xml"));
}

TEST(QosProfiles, ReportAMissingFile) {
    const auto profiles = load_qos_profiles("/nowhere/profiles.xml");
    ASSERT_FALSE(profiles.has_value());
    EXPECT_EQ(profiles.error().kind, ErrorKind::kNotFound);
    EXPECT_THAT(profiles.error().message, HasSubstr("/nowhere/profiles.xml"));
    EXPECT_FALSE(load_qos_profiles("/").has_value()) << "a directory";
}

TEST(NetworkFile, IsReducedToItsElements) {
    const auto text = parse_network_file(
        "<?xml version='1.0'?><!-- why --><CycloneDDS><!-- x --><Domain/></CycloneDDS>",
        "here.xml");
    ASSERT_TRUE(text.has_value());
    EXPECT_EQ(*text, "<CycloneDDS><Domain/></CycloneDDS>");
}

TEST(NetworkFile, NamesAnIllFormedOrForeignFile) {
    const auto cut = parse_network_file("<CycloneDDS><Domain>", "here.xml");
    ASSERT_FALSE(cut.has_value());
    EXPECT_THAT(cut.error().message, AllOf(HasSubstr("here.xml"), HasSubstr("not valid XML")));
    const auto other = parse_network_file("<dds/>", "here.xml");
    ASSERT_FALSE(other.has_value());
    EXPECT_THAT(other.error().message, AllOf(HasSubstr("<dds>"), HasSubstr("<CycloneDDS>")));
}

}  // namespace
}  // namespace atrium::bus
