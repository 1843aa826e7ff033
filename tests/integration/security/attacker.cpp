#include "core/base/text_file.hpp"
#include "core/bus/network_settings.hpp"
#include "core/bus/participant.hpp"
#include "core/bus/topics.hpp"
#include "core/bus/wire.hpp"
#include "core/keys/bundle.hpp"
#include "tests/integration/security/forged_object.hpp"

#include <CLI/CLI.hpp>
#include <dds/dds.h>

#include <csignal>
#include <cstdio>
#include <map>
#include <thread>

/// A program of an attacker in or beside a world with keys: uses Cyclone DDS without Atrium's
/// checks of keys, names and rights. It writes samples of one topic in a partition of its choice,
/// thirty a second, reads meshes and states in partitions of its choice, and prints "writes",
/// "written N" or "refused WHAT"; when it ends "heard N" and when it last heard something.
namespace atrium {
namespace {

volatile std::sig_atomic_t stop = 0;
constexpr std::uint64_t kFirstFrame = 1'000'000;

struct Attack {
    std::uint32_t domain = 0;
    std::string bundle;          // file; empty: no keys
    std::string access_control;  // path of the plugin; empty: Cyclone's
    std::string topic;           // that it writes; empty: none
    std::string site;            // key of its samples, or sender
    std::string partition;       // that it writes
    std::string read_partition;  // empty: reads nothing
    bool dispose = false;        // disposes after each sample
};

[[noreturn]] void refused(const std::string& what, dds_return_t code) {
    std::printf("refused %s: %s\n", what.c_str(), dds_strretcode(code));
    std::fflush(stdout);
    std::exit(0);
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

dds_entity_t join(const Attack& attack) {
    bus::BusOptions options;
    options.domain = attack.domain;
    if (!attack.bundle.empty()) {
        const auto text = read_text_file(attack.bundle);
        auto bundle = text ? keys::parse_bundle(*text, attack.bundle)
                           : Expected<keys::Bundle>(tl::unexpected(text.error()));
        if (!bundle) {
            std::fprintf(stderr, "%s\n", bundle.error().message.c_str());
            std::exit(2);
        }
        options.keys = std::make_shared<const keys::Bundle>(std::move(*bundle));
    }
    auto settings = bus::load_network_settings(options);
    if (!settings) {
        std::fprintf(stderr, "%s\n", settings.error().message.c_str());
        std::exit(2);
    }
    if (!attack.access_control.empty())
        replace_all(settings->xml, "\"dds_security_ac\"", "\"" + attack.access_control + "\"");
    if (const dds_entity_t domain = dds_create_domain(attack.domain, settings->xml.c_str());
        domain < 0)
        refused("domain", domain);
    const dds_entity_t participant = dds_create_participant(attack.domain, nullptr, nullptr);
    if (participant < 0) refused("participant", participant);
    return participant;
}

template <typename Message>
dds_entity_t topic_of(dds_entity_t participant) {
    const dds_entity_t topic = dds_create_topic(participant,
                                                &bus::Topic<Message>::kDescriptor,
                                                bus::Topic<Message>::kName,
                                                nullptr,
                                                nullptr);
    if (topic < 0) refused("topic", topic);
    return topic;
}

class AnyWriter {
public:
    virtual ~AnyWriter() = default;
    virtual dds_return_t write(std::uint64_t number, bool dispose) = 0;
};

template <typename Message>
class WriterOf final : public AnyWriter {
public:
    WriterOf(dds_entity_t participant, const Attack& attack, Message message)
        : message_(std::move(message)) {
        const dds_entity_t topic = topic_of<Message>(participant);
        const auto profiles = bus::load_qos_profiles({});
        const auto& profile = profiles->find(bus::Topic<Message>::kProfile)->second;
        const auto partition = bus::partition_qos({attack.partition});
        const dds_entity_t publisher = dds_create_publisher(participant, partition.get(), nullptr);
        writer_ = dds_create_writer(
            publisher, topic, bus::make_writer_qos(profile.writer).get(), nullptr);
        if (writer_ < 0) refused("writer", writer_);
    }
    dds_return_t write(std::uint64_t number, bool dispose) override {
        if constexpr (requires { message_.frame_id; }) message_.frame_id = kFirstFrame + number;
        if constexpr (requires { message_.capture_time; }) message_.capture_time = Timestamp::now();
        bus::WireOf<Message> wire{};
        bus::to_wire(message_, scratch_, wire);
        const dds_return_t result = dds_write(writer_, &wire);
        return result < 0 || !dispose ? result : dds_dispose(writer_, &wire);
    }

private:
    Message message_;
    dds_entity_t writer_ = 0;
    bus::WireScratch scratch_;
};

std::unique_ptr<AnyWriter> writer_of(dds_entity_t participant, const Attack& attack) {
    if (attack.topic == "SiteMesh") {
        bus::SiteMesh mesh;
        mesh.site = attack.site;
        mesh.draco.assign(1000, 7);
        return std::make_unique<WriterOf<bus::SiteMesh>>(participant, attack, mesh);
    }
    if (attack.topic == "SiteDescription") {
        bus::SiteDescription description;
        description.site = attack.site;
        description.bounds_site.add({-1, -1, 0});
        description.bounds_site.add({1, 1, 2});
        return std::make_unique<WriterOf<bus::SiteDescription>>(participant, attack, description);
    }
    if (attack.topic == "SceneState") {
        bus::SceneState state;
        state.world = attack.site;
        state.objects.emplace_back().object = atrium::test::kForgedObject;
        return std::make_unique<WriterOf<bus::SceneState>>(participant, attack, state);
    }
    if (attack.topic == "SitePlacement") {
        bus::SitePlacement placement;
        placement.site = attack.site;
        return std::make_unique<WriterOf<bus::SitePlacement>>(participant, attack, placement);
    }
    if (attack.topic == "SceneEdit") {
        bus::SceneEdit edit;
        edit.sender = attack.site;
        edit.kind = bus::EditKind::kRemove;
        edit.target = 1;
        return std::make_unique<WriterOf<bus::SceneEdit>>(participant, attack, edit);
    }
    std::fprintf(stderr, "no topic %s\n", attack.topic.c_str());
    std::exit(2);
}

template <typename Message>
dds_entity_t reader_of(dds_entity_t participant, const std::string& read_partition) {
    const auto profiles = bus::load_qos_profiles({});
    const auto& profile = profiles->find(bus::Topic<Message>::kProfile)->second;
    const auto partition = bus::partition_qos({read_partition});
    const dds_entity_t subscriber = dds_create_subscriber(participant, partition.get(), nullptr);
    const dds_entity_t reader = dds_create_reader(subscriber,
                                                  topic_of<Message>(participant),
                                                  bus::make_reader_qos(profile.reader).get(),
                                                  nullptr);
    if (reader < 0) refused("reader", reader);
    return reader;
}

std::uint64_t take_all(dds_entity_t reader) {
    std::uint64_t num = 0;
    for (;;) {
        void* sample = nullptr;
        dds_sample_info_t info{};
        if (dds_take(reader, &sample, &info, 1, 1) <= 0) return num;
        // not what it writes itself
        const bool is_own =
            static_cast<const bus::WireOf<bus::SiteMesh>*>(sample)->frame_id >= kFirstFrame;
        if (info.valid_data && !is_own) ++num;
        dds_return_loan(reader, &sample, 1);
    }
}

int run(const Attack& attack) {
    const dds_entity_t participant = join(attack);
    std::unique_ptr<AnyWriter> writer;
    if (!attack.topic.empty()) writer = writer_of(participant, attack);
    std::optional<dds_entity_t> reader;
    if (!attack.read_partition.empty())
        reader = reader_of<bus::SiteMesh>(participant, attack.read_partition);
    std::puts("acts");
    std::fflush(stdout);
    std::uint64_t num_written = 0;
    std::uint64_t num_heard = 0;
    Timestamp last_heard;
    while (stop == 0) {
        if (writer && writer->write(num_written, attack.dispose) >= 0) ++num_written;
        if (reader) {
            const std::uint64_t num = take_all(*reader);
            if (num > 0 && num_heard == 0) {
                std::puts("hears");
                std::fflush(stdout);
            }
            num_heard += num;
            if (num > 0) last_heard = Timestamp::now();
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(33));  // the attack's rate
    }
    std::printf("written %llu\nheard %llu\nlast_heard_ns %lld\n",
                static_cast<unsigned long long>(num_written),
                static_cast<unsigned long long>(num_heard),
                static_cast<long long>(last_heard.ns));
    std::fflush(stdout);
    std::_Exit(0);  // threads of Cyclone are in the plugin
}

}  // namespace
}  // namespace atrium

int main(int argc, char** argv) {
    atrium::Attack attack;
    CLI::App cli;
    cli.add_option("--domain", attack.domain);
    cli.add_option("--bundle", attack.bundle);
    cli.add_option("--access-control", attack.access_control);
    cli.add_option("--topic", attack.topic);
    cli.add_option("--site", attack.site);
    cli.add_option("--partition", attack.partition);
    cli.add_option("--read", attack.read_partition);
    cli.add_flag("--dispose", attack.dispose);
    CLI11_PARSE(cli, argc, argv);
    std::signal(SIGTERM, [](int) { atrium::stop = 1; });
    return atrium::run(attack);
}
