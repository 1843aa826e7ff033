#include "core/keys/documents.hpp"
#include "tests/integration/security/closed_world_fixture.hpp"

// Attackers at a world with keys: nothing of them gets through, the honest programs lose nothing,
// and their logs name who and why.
namespace atrium::test {
namespace {

using testing::Not;

Timestamp last_heard(const std::string& output) {
    const std::string word = "last_heard_ns ";
    const auto at = output.find(word);
    return {at == std::string::npos ? 0 : std::stoll(output.substr(at + word.size()))};
}

const std::vector<std::string> kMeshesAsAlice{
    "--topic", "SiteMesh", "--site", "alice", "--partition", "playroom/site/alice"};

std::vector<std::string> and_reads(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--read", "playroom/site/alice"});
    return arguments;
}

TEST_F(ClosedWorldTest, ProgramWithoutKeysIsDeafAndDumb) {
    attack({}, and_reads(kMeshesAsAlice));
    let_pass();
    EXPECT_TRUE(log_has(fmt::format("pid {}\" reason=\"it has no keys", attacker_->id())))
        << world().logs();
    end_deaf();
}

TEST_F(ClosedWorldTest, ProgramWithoutKeysLearnsThatTheWorldIsClosed) {
    const auto watch = world().start("stream_watch", {});
    const std::string about_alice = fmt::format(
        "pid {}\" reason=\"it tells nothing to programs "
        "without keys",
        world().alice().id());
    EXPECT_TRUE(world().wait_until(
        [&] { return watch->output().find(about_alice) != std::string::npos; }, 30s))
        << watch->output();
    watch->signal(SIGTERM);
    EXPECT_TRUE(watch->wait(20s));
}

TEST_F(ClosedWorldTest, KeysOfAnotherStoreAreRefused) {
    auto other = value(
        keys::KeyStore::create(world().folder() / "other.keys", "playroom", 365, Timestamp::now()));
    value(other.add({"playroom", Kind::kSite, "alice", {}}, 30, Timestamp::now()));
    const auto bundle = keys::bundle_text(value(other.bundle("alice")));
    attack(world().write("foreign.bundle", bundle), and_reads(kMeshesAsAlice));
    let_pass();
    // Chance decides who begins the handshake. If the attacker refuses first, it says nothing.
    const std::string process = fmt::format("pid {}\" reason=", attacker_->id());
    const std::string why = "\"its key is of another key store";
    EXPECT_TRUE(world().wait_until([&] {
        const std::string logs = world().logs();
        const std::string who = "site alice of world playroom, by its own words";
        return (logs.find("refused peer=\"" + who + "\" reason=" + why + "\"") !=
                    std::string::npos &&
                logs.find(process + why + " (" + who + ")\"") != std::string::npos) ||
               logs.find(process + "\"no handshake comes about") != std::string::npos;
    })) << world().logs();
    end_deaf();
}

TEST_F(ClosedWorldTest, RevokedKeyIsRefusedAndARunningProgramIsCutOff) {
    const fs::path bundle = world().add(Kind::kViewer, "eve", Rights::all());
    attack(bundle, {"--read", "playroom/site/*"});
    ASSERT_TRUE(world().wait_until([&] {
        return attacker_->output().find("hears") != std::string::npos;
    })) << attacker_->output();
    const std::string process = fmt::format("pid {}\" reason=", attacker_->id());
    const auto is_doubted = [&process] {  // perhaps at first: a handshake can take long
        return world().logs().find(process + "\"no handshake comes about") != std::string::npos;
    };
    const bool was_doubted = is_doubted();
    value(world().store().revoke("eve", keys::Reason::kLost, Timestamp::now()));
    // only the world server gets the new list: the site hears of it from there
    world().export_bundle("playroom");
    const Timestamp begin = Timestamp::now();
    ASSERT_TRUE(world().wait_until(
        [&] {
            return world().world_server().output().find("cut_off peer=\"viewer eve\"") !=
                       std::string::npos &&
                   world().alice().output().find("cut_off peer=\"viewer eve\"") !=
                       std::string::npos;
        },
        10s))
        << world().logs();
    // of the program that goes on nobody says anything else than that
    EXPECT_TRUE(log_has(process + "\"its key is revoked (viewer eve)\"")) << world().logs();
    EXPECT_EQ(is_doubted(), was_doubted) << world().logs();
    EXPECT_THAT(world().logs(), HasSubstr("revoked_keys new=1"));
    EXPECT_LT(last_heard(end()) - begin, 2s);
    attack(bundle, {"--read", "playroom/site/*"});  // again
    let_pass();
    EXPECT_TRUE(log_has("refused peer=\"viewer eve\" reason=\"its key is revoked\""))
        << world().logs();
    end_deaf();
    // in her own log: her bundle does not know that it is revoked
    const auto watch = world().start("stream_watch", {"--security", bundle.string()});
    EXPECT_TRUE(world().wait_until(
        [&] {
            const std::string output = watch->output();
            return output.find("no handshake comes about") != std::string::npos ||
                   output.find("refuses this program's key, which may be revoked") !=
                       std::string::npos;
        },
        40s))
        << watch->output();
    watch->signal(SIGTERM);
    EXPECT_TRUE(watch->wait(20s));
}

TEST_F(ClosedWorldTest, WrongFileOverTheOwnBundleIsNamed) {
    world().add(Kind::kViewer, "frank");
    const fs::path file = world().folder() / "alice.bundle";
    const auto alice_says = [](const std::string& text) {
        return world().wait_until(
            [&] { return world().alice().output().find(text) != std::string::npos; });
    };
    fs::permissions(file, fs::perms(0644));
    EXPECT_TRUE(alice_says("bundle_not_read reason=\"" + file.string() + ": others can read"));
    fs::permissions(file, fs::perms(0600));
    EXPECT_TRUE(alice_says("bundle_good_again file=" + file.string()));
    world().write("alice.bundle", keys::bundle_text(value(world().store().bundle("frank"))));
    EXPECT_TRUE(alice_says("it is the bundle of viewer frank of world playroom, and this program"));
    world().export_bundle("alice");
    let_pass();
    EXPECT_THAT(world().alice().output(), Not(HasSubstr("start this program again")));
}

TEST_F(ClosedWorldTest, KeyThatExpiresWhileItsProgramRunsIsCutOff) {
    // made a day ago, but for some seconds
    constexpr std::chrono::seconds kLeft{12};
    const Timestamp end_of_key = Timestamp::now() + kLeft;
    const fs::path bundle =
        world().add(Kind::kViewer, "ed", {}, end_of_key + -std::chrono::hours(24), 1);
    attack(bundle, {"--read", "playroom/site/*"});
    ASSERT_TRUE(world().wait_until([&] {
        return attacker_->output().find("hears") != std::string::npos;
    })) << attacker_->output();
    ASSERT_TRUE(world().wait_until(
        [&] { return Timestamp::now() > end_of_key + std::chrono::seconds(2); }));
    EXPECT_LT(last_heard(end()) - end_of_key, 1s);
    EXPECT_TRUE(log_has("viewer ed")) << world().logs();
    attack(bundle, {"--read", "playroom/site/*"});
    let_pass();
    EXPECT_THAT(end(), testing::AnyOf(HasSubstr("heard 0"), HasSubstr("refused participant")));
}

TEST_F(ClosedWorldTest, TamperedPermissionsAreRefused) {
    auto bundle = value(keys::parse_bundle(
        keys::bundle_text(value(world().store().bundle(
            value(world().store().add({"playroom", Kind::kViewer, "tim", {}}, 30, Timestamp::now()))
                .member.name))),
        "tim"));
    std::string tampered = bundle.permissions;
    const std::string own = "playroom/viewer/tim";
    const auto at = tampered.find(own);
    ASSERT_NE(at, std::string::npos);
    tampered.replace(at, own.size(), "playroom/viewer/bob");
    const fs::path honest = world().write("tim.bundle", keys::bundle_text(bundle));
    bundle.permissions = tampered;
    attack(world().write("tampered.bundle", keys::bundle_text(bundle)),
           {"--read", "playroom/site/*"});
    ASSERT_TRUE(attacker_->wait(20s)) << "joined";
    EXPECT_THAT(attacker_->output(), HasSubstr("refused participant"));
    // a patched plugin shows good permissions to itself and the others to its peers
    ::setenv("ATTACKER_PERMISSIONS", world().write("tampered.smime", tampered).c_str(), 1);
    attack_freely(honest, {"--read", "playroom/site/*"});
    ::unsetenv("ATTACKER_PERMISSIONS");
    let_pass();
    EXPECT_TRUE(log_has("viewer tim")) << world().logs();
    end_deaf();
}

TEST_F(ClosedWorldTest, PermissionsOfAnotherAndSelfSignedOnesAreRefused) {
    const fs::path honest = world().add(Kind::kViewer, "olga");
    const keys::Bundle olga = value(world().store().bundle("olga"));
    const keys::Bundle alice = value(world().store().bundle("alice"));
    const std::string xml = value(keys::verify_document(olga.permissions, olga.permissions_ca));
    const std::string self_signed =
        value(keys::sign_document(xml, {olga.certificate, olga.private_key}));
    for (const std::string& permissions : {alice.permissions, self_signed}) {
        keys::Bundle bundle = olga;
        bundle.permissions = permissions;
        attack(world().write("wrong.bundle", keys::bundle_text(bundle)),
               {"--read", "playroom/site/*"});
        ASSERT_TRUE(attacker_->wait(20s)) << "joined";
        EXPECT_THAT(attacker_->output(), HasSubstr("refused participant"));
        ::setenv("ATTACKER_PERMISSIONS", world().write("wrong.smime", permissions).c_str(), 1);
        attack_freely(honest, {"--read", "playroom/site/*"});
        ::unsetenv("ATTACKER_PERMISSIONS");
        let_pass();
        EXPECT_TRUE(log_has("viewer olga")) << world().logs();
        end_deaf();
    }
}

TEST_F(ClosedWorldTest, SiteCannotSpeakForAnother) {
    const fs::path bundle = world().add(Kind::kSite, "mallory");
    for (const bool dispose : {false, true}) {
        std::vector<std::string> arguments{
            "--topic", "SiteMesh", "--site", "alice", "--partition", "playroom/site/mallory"};
        if (dispose) arguments.push_back("--dispose");
        attack(bundle, arguments);
        let_pass();
        EXPECT_TRUE(
            log_has("refused topic=SiteMesh from=\"site mallory\" reason=\"its samples are of "
                    "'alice'"))
            << world().logs();
        EXPECT_THAT(end(), HasSubstr("acts"));
    }
    attack(bundle, kMeshesAsAlice);  // in the partition of alice
    ASSERT_TRUE(attacker_->wait(20s));
    EXPECT_THAT(attacker_->output(), HasSubstr("refused writer"));
    attack_freely(bundle, kMeshesAsAlice);
    let_pass();
    EXPECT_TRUE(log_has("site mallory")) << world().logs();
    EXPECT_THAT(end(), HasSubstr("acts"));
}

TEST_F(ClosedWorldTest, ViewerCannotPublishMeshesStatesOrPlacements) {
    const fs::path bundle = world().add(Kind::kViewer, "vera", Rights::all());
    const std::vector<std::vector<std::string>> attacks{
        kMeshesAsAlice,
        {"--topic", "SceneState", "--site", "playroom", "--partition", "playroom/world"},
        {"--topic", "SitePlacement", "--site", "vera", "--partition", "playroom/world"}};
    for (const auto& arguments : attacks) {
        attack(bundle, arguments);
        ASSERT_TRUE(attacker_->wait(20s));
        EXPECT_THAT(attacker_->output(), HasSubstr("refused")) << arguments[1];
        attack_freely(bundle, arguments);
        let_pass();
        EXPECT_THAT(end(), HasSubstr("acts")) << arguments[1];
    }
    EXPECT_TRUE(log_has("viewer vera")) << world().logs();
}

TEST_F(ClosedWorldTest, CommandsBeyondTheRightsOfTheKeyAreRefused) {
    const fs::path bundle = world().add(Kind::kViewer, "carol", {Right::kPush});
    const auto removes_as = [](const std::string& sender, const std::string& rights) {
        return std::vector<std::string>{"--topic",
                                        "SceneEdit",
                                        "--site",
                                        sender,
                                        "--partition",
                                        "playroom/command/carol/" + rights};
    };
    attack(bundle, removes_as("carol", "push"));
    EXPECT_TRUE(
        log_has("edit of carol: not allowed: the key of carol does not have the right remove"))
        << world().logs();
    end();
    attack(bundle, removes_as("bob", "push"));
    EXPECT_TRUE(
        log_has("refused topic=SceneEdit from=\"member carol\" reason=\"its samples are of "
                "'bob'"))
        << world().logs();
    end();
    attack(bundle, removes_as("carol", "remove"));
    ASSERT_TRUE(attacker_->wait(20s));
    EXPECT_THAT(attacker_->output(), HasSubstr("refused writer"));
    attack_freely(bundle, removes_as("carol", "remove"));
    let_pass();
    EXPECT_THAT(end(), HasSubstr("acts"));
}

}  // namespace
}  // namespace atrium::test
