#include "tests/integration/security/closed_world.hpp"

#include "core/bus/entity.hpp"
#include "core/bus/participant.hpp"
#include "core/keys/private_file.hpp"
#include "tests/integration/swaying_person.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <thread>

namespace atrium::test {
namespace {

constexpr const char* kWorldName = "playroom";
constexpr std::size_t kMaxPayloads = 4000;

}  // namespace

ClosedWorld::ClosedWorld(std::uint32_t domain)
    : domain_(domain),
      store_(value(
          keys::KeyStore::create(folder_ / "playroom.keys", kWorldName, 365, Timestamp::now()))) {
    write_swaying_person(folder_ / "recording", 4);
    std::ofstream(folder_ / "alice.toml") << fmt::format(R"([site]
name = "alice"
[capture]
source = "recording"
recording = "{}"
rate_hz = 10
min_cameras = 4
loop = true
aligned = true
)",
                                                         (folder_ / "recording").string());
    std::ofstream(folder_ / "world.toml") << R"([[object]]
name = "box"
shape = "box"
size_m = [0.2, 0.2, 0.2]
position_m = [0, 0, 1]
mass_kg = 1
)";
    add(keys::Kind::kWorld, kWorldName);
    add(keys::Kind::kSite, "alice");
    const fs::path mona = add(keys::Kind::kMonitor, "mona");
    world_server_ = start("world_server",
                          {"--config",
                           (folder_ / "world.toml").string(),
                           "--security",
                           (folder_ / "playroom.bundle").string()});
    alice_ = start("site_node",
                   {"--config",
                    (folder_ / "alice.toml").string(),
                    "--security",
                    (folder_ / "alice.bundle").string()});
    bus::BusOptions options;
    options.domain = domain_;
    options.security = mona.string();
    monitor_ = value(bus::Participant::create(options));
    meshes_ = value(bus::Reader<bus::SiteMesh>::create(*monitor_));
    statuses_ = value(bus::Reader<bus::SiteStatus>::create(*monitor_));
    textures_ = value(bus::Reader<bus::CameraTexture>::create(*monitor_));
    states_ = value(bus::Reader<bus::SceneState>::create(*monitor_));
    placements_ = value(bus::Reader<bus::SitePlacement>::create(*monitor_));
    waiter_ = value(bus::Waiter::create(*monitor_));
    waiter_->add(*meshes_);
    if (!wait_until([this] { return num_meshes_ >= 5 && num_states_ > 0; },
                    std::chrono::seconds(60)))
        throw std::runtime_error("alice or the world server publishes nothing:\n" + logs());
}

ClosedWorld::~ClosedWorld() {
    for (HostedProcess* program : {alice_.get(), world_server_.get()}) {
        if (program == nullptr) continue;
        program->signal(SIGTERM);
        program->wait(std::chrono::seconds(60));
    }
}

fs::path ClosedWorld::add(
    keys::Kind kind, const std::string& name, keys::Rights rights, Timestamp now, int days) {
    value(store_.add({kWorldName, kind, name, rights}, days, now));
    return export_bundle(name);
}

fs::path ClosedWorld::export_bundle(const std::string& name) {
    return write(name + ".bundle", keys::bundle_text(value(store_.bundle(name))));
}

fs::path ClosedWorld::write(const std::string& name, const std::string& text) const {
    const fs::path file = folder_ / name;
    if (!keys::write_private_file(file, text, keys::Existing::kReplace))
        throw std::runtime_error("cannot write " + file.string());
    return file;
}

std::unique_ptr<HostedProcess> ClosedWorld::start(const std::string& program,
                                                  const std::vector<std::string>& arguments) const {
    std::vector<std::string> command{std::string(ATRIUM_BIN_DIR) + "/" + program};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const char* const domain = program.starts_with("security_") ? "--domain" : "--bus.domain";
    command.insert(command.end(), {domain, std::to_string(domain_)});
    return value(HostedProcess::start(command));
}

std::string ClosedWorld::take() {
    std::string wrong;
    const auto keep = [this](std::vector<std::uint8_t>&& payload) {
        if (payloads_.size() < kMaxPayloads) payloads_.push_back(std::move(payload));
    };
    meshes_->take(
        [&](bus::SiteMesh&& mesh) {
            if (mesh.site != "alice") {
                wrong = "a mesh of " + mesh.site;
            } else if (!gaps_.take(mesh)) {
                wrong = fmt::format("frame {} again, or too late", mesh.frame_id);
            }
            keep(std::move(mesh.draco));
            ++num_meshes_;
        },
        [&](const bus::SiteMesh& gone, bus::Ending) { wrong = "the end of " + gone.site; });
    statuses_->take([&](bus::SiteStatus&& status) {
        if (status.site != "alice") wrong = "a status of " + status.site;
        gaps_.take(status);
    });
    textures_->take([&](bus::CameraTexture&& texture) { keep(std::move(texture.colour)); });
    states_->take([&](bus::SceneState&& state) {
        ++num_states_;
        if (state.world != kWorldName) wrong = "a state of " + state.world;
        for (const bus::ObjectState& object : state.objects)
            if (object.object == kForgedObject) wrong = "a forged state";
    });
    placements_->take([&](bus::SitePlacement&& placement) {
        if (placement.site != "alice") wrong = "a forged placement";
    });
    for (const std::string& line : monitor_->take_mismatches()) own_log_ += line + "\n";
    for (const std::string& line : monitor_->take_dds_log()) own_log_ += line + "\n";
    return wrong;
}

std::optional<std::uint64_t> ClosedWorld::count_lost() {
    const std::uint64_t num_missing = gaps_.num_missing();
    const Timestamp now = Timestamp::now();
    if (!wait_until([&] { return gaps_.covers(now); })) return std::nullopt;
    return gaps_.num_lost(num_missing);
}

std::size_t ClosedWorld::num_participants() const {
    const bus::Entity reader(dds_create_reader(
        monitor_->impl()->participant.get(), DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr));
    constexpr std::size_t kMax = 4096;
    std::vector<void*> samples(kMax, nullptr);
    std::vector<dds_sample_info_t> infos(kMax);
    const int num =
        dds_take_mask(reader.get(),
                      samples.data(),
                      infos.data(),
                      kMax,
                      kMax,
                      DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE);
    if (num < 0) throw std::runtime_error(dds_strretcode(num));
    if (num > 0) dds_return_loan(reader.get(), samples.data(), num);
    return static_cast<std::size_t>(num);
}

std::string ClosedWorld::logs() const {
    return "--- world server\n" + world_server_->output() + "--- alice\n" + alice_->output() +
           "--- monitor\n" + own_log_;
}

bool ClosedWorld::wait_until(const std::function<bool()>& condition,
                             std::chrono::milliseconds patience) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < end) {
        waiter_->wait(std::chrono::milliseconds(50));
        if (const std::string wrong = take(); !wrong.empty()) {
            ADD_FAILURE() << wrong;
            return false;
        }
        if (condition()) return true;
    }
    return false;
}

}  // namespace atrium::test
