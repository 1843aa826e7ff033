#include "tests/fuzz/wire_check.hpp"

#include "core/bus/checks.hpp"
#include "core/bus/limits.hpp"
#include "core/bus/names.hpp"
#include "core/bus/topics.hpp"
#include "core/bus/wire.hpp"
#include "tests/fuzz/wire_input.hpp"
#include "tests/fuzz/wire_promises.hpp"
#include "tests/support/cdr_type.hpp"
#include "tests/unit/bus/random_messages.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <string_view>

namespace atrium::test {
namespace {

enum class Reading { kSample, kEndOfKey, kFields };
constexpr int kNumReadings = 3;

/// The content of a wire struct field by field, without the bytes after the ends of names. Notes
/// values that no message may hold.
class Statement : public bus::FieldVisitor<Statement> {
public:
    template <typename Message>
    static Statement of(const bus::WireOf<Message>& wire) {
        Statement statement;
        Message message;
        // the only fields that a list depends on
        if constexpr (std::is_same_v<Message, bus::SceneCommand>) bus::get(wire.kind, message.kind);
        if constexpr (std::is_same_v<Message, bus::SceneEdit>) bus::get(wire.kind, message.kind);
        fields(statement, message, wire);
        return statement;
    }

    template <typename Member, typename Wire, typename Limits>
    void field(std::string_view /*name*/, const Member&, const Wire& wire, const Limits& limits) {
        if constexpr (std::is_same_v<Limits, bus::Text>) {
            add_text(wire, limits);
        } else if constexpr (!bus::kIsVector<Member>) {
            add(wire);
        } else {
            append(wire._length);
            for (std::uint32_t i = 0; i < wire._length; ++i) {
                if constexpr (std::is_class_v<bus::ElementOf<Wire>>)
                    fields(*this, kNoMessage<typename Member::value_type>, wire._buffer[i]);
                else
                    add(wire._buffer[i]);
            }
        }
    }

    std::vector<std::uint8_t> bytes;  // of everything except rotations
    std::vector<Eigen::Vector4d> rotations;
    std::string wrong;

private:
    template <typename Value>
    void append(const Value& value) {
        const auto* begin = reinterpret_cast<const std::uint8_t*>(&value);
        bytes.insert(bytes.end(), begin, begin + sizeof(value));
    }

    void add(double value) {
        if (!(std::abs(value) <= bus::kMaxStatistic)) wrong = "a number";
        append(value);
    }
    void add(std::int64_t time_ns) {
        if (time_ns < 0 || time_ns > bus::kMaxTime_ns) wrong = "a time";
        append(time_ns);
    }
    void add(std::uint8_t value) { append(value); }
    void add(bool value) { append(value); }
    void add(std::uint16_t value) { append(value); }
    void add(std::int16_t value) { append(value); }
    void add(std::uint32_t value) { append(value); }
    void add(std::uint64_t value) { append(value); }

    void add_text(const atrium_Name& name, bus::Text kind) {
        const std::string_view text(name, strnlen(name, sizeof(name)));
        const auto is_bad = [](char c) {
            return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '.' &&
                   c != '-';
        };
        if ((text.empty() && kind != bus::Text::kNameOrNone) || text.size() > bus::kMaxNameLength ||
            std::any_of(text.begin(), text.end(), is_bad))
            wrong = "a name";
        bytes.insert(bytes.end(), text.begin(), text.end());
        bytes.push_back(0);
    }
    void add_text(const atrium_ModelFile& file, bus::Text) {
        const std::string_view text(file, strnlen(file, sizeof(file)));
        if (text.size() == sizeof(file) || (!text.empty() && !bus::is_valid_model_file(text)))
            wrong = "a model's file";
        if (("/" + std::string(text)).find("/.") != std::string::npos) wrong = "a way out";
        bytes.insert(bytes.end(), text.begin(), text.end());
        bytes.push_back(0);
    }
    void add_text(const char (&line)[bus::kMaxTextLength + 1], bus::Text) {
        const std::string_view text(line, strnlen(line, sizeof(line)));
        if (text.size() == sizeof(line) ||
            std::any_of(text.begin(), text.end(), [](char c) { return c < 0x20 || c >= 0x7f; }))
            wrong = "a text";
        bytes.insert(bytes.end(), text.begin(), text.end());
        bytes.push_back(0);
    }
    void add(const atrium_Pose& pose) {
        rotations.emplace_back(pose.rotation);
        add(pose.translation);
    }
    void add(const atrium_Latency& latency) {
        add(latency.median_ms);
        add(latency.p99_ms);
        add(latency.num_samples);
    }

    template <typename Number, std::size_t kSize>
    void add(const Number (&values)[kSize]) {
        for (const Number value : values) add(value);
    }
};

/// The length of a rotation may change slightly, and nothing else.
std::string compare(const Statement& received, const Statement& accepted) {
    constexpr double kRounding = 2e-15;
    if (received.bytes != accepted.bytes) return "not what was received";
    if (received.rotations.size() != accepted.rotations.size()) return "not as many rotations";
    for (std::size_t i = 0; i < accepted.rotations.size(); ++i) {
        if (!(std::abs(accepted.rotations[i].norm() - 1.0) <= kRounding))
            return "a rotation's length";
        const Eigen::Vector4d change = accepted.rotations[i] - received.rotations[i];
        if (!(change.norm() <= 1.01 * bus::kQuaternionTolerance)) return "another rotation";
    }
    return "";
}

using bus::WireOf;

/// `message` was read from `wire`.
template <typename Message>
std::string check_accepted(WireOf<Message>& wire, const Message& message) {
    if (const std::string broken = broken_promise(message); !broken.empty()) return broken;
    bus::WireScratch scratch;
    WireOf<Message> sent{};
    bus::to_wire(message, scratch, sent);
    const Statement statement = Statement::of<Message>(sent);
    if (!statement.wrong.empty()) return statement.wrong;
    if (const std::string change = compare(Statement::of<Message>(wire), statement);
        !change.empty())
        return change;

    const auto back = bus::from_wire<Message>(sent);
    if (!back) return "refuses what it accepted: " + back.error().message;
    if (!bus::testing::same(*back, message)) return "another message on the way back";
    bus::WireScratch other_scratch;
    WireOf<Message> sent_again{};
    bus::to_wire(*back, other_scratch, sent_again);
    const Statement again = Statement::of<Message>(sent_again);
    const bool is_same = again.bytes == statement.bytes && again.rotations == statement.rotations;
    return is_same ? "" : "is sent in another way again";
}

template <typename Message>
std::string check_key(const WireOf<Message>& wire, bool& was_accepted) {
    const auto key = bus::key_from_wire<Message>(wire);
    was_accepted = key.has_value();
    if (!key) return key.error().kind == ErrorKind::kInvalidData ? "" : "another kind of error";
    WireOf<Message> sent{};
    bus::key_to_wire(*key, sent);
    const auto back = bus::key_from_wire<Message>(sent);
    if (!back) return "refuses the key that it accepted";
    WireOf<Message> sent_again{};
    bus::key_to_wire(*back, sent_again);
    return std::memcmp(&sent, &sent_again, sizeof(sent)) == 0 ? "" : "another key on the way back";
}

template <typename Message>
std::string check_sample(WireOf<Message>& wire, std::size_t num_payload, bool& was_accepted) {
    const auto message = bus::from_wire<Message>(wire);
    was_accepted = message.has_value();
    bool is_key = false;
    const std::string wrong = check_key<Message>(wire, is_key);
    if (!wrong.empty()) return wrong;
    if (!message)
        return message.error().kind == ErrorKind::kInvalidData ? "" : "another kind of error";
    if (!is_key) return "a message without a key";
    if (num_payload > 0 && bus::payload_bytes(*message) > num_payload)
        return "more payload than came";
    return check_accepted(wire, *message);
}

template <typename Message>
const CdrType& cdr_type() {
    static const CdrType type = [] {
        bus::testing::Random random(1);
        const auto message = bus::testing::random_message<Message>(random);
        bus::WireScratch scratch;
        WireOf<Message> wire{};
        bus::to_wire(message, scratch, wire);
        return CdrType(bus::Topic<Message>::kDescriptor, bus::Topic<Message>::kName, &wire);
    }();
    return type;
}

/// A wire struct whose content Cyclone allocates.
template <typename Message>
struct Received {
    Received() = default;
    Received(const Received&) = delete;
    Received& operator=(const Received&) = delete;
    ~Received() { cdr_type<Message>().free_contents(&wire); }
    WireOf<Message> wire{};
};

template <typename Message>
std::string check_end_of_key(std::span<const std::uint8_t> payload, bool& was_accepted) {
    const auto data = cdr_type<Message>().accept(payload, SDK_KEY);
    if (!data) return "";
    Received<Message> key;
    if (!cdr_type<Message>().read_key(*data, &key.wire)) return "";
    return check_key<Message>(key.wire, was_accepted);
}

template <typename Message>
std::string check_payload(std::span<const std::uint8_t> payload, bool& was_accepted) {
    const CdrType& type = cdr_type<Message>();
    const auto data = type.accept(payload, SDK_DATA);
    if (!data) return "";
    Received<Message> sample;
    if (!type.read(*data, &sample.wire)) return "";
    const std::string wrong = check_sample<Message>(sample.wire, payload.size(), was_accepted);
    if (!wrong.empty() || !was_accepted) return wrong;

    // Cyclone reuses structs that it has read into before
    const Statement first = Statement::of<Message>(sample.wire);
    if (!type.read(*data, &sample.wire)) return "is not read twice";
    if (Statement::of<Message>(sample.wire).bytes != first.bytes)
        return "is read as another the next time";
    Received<Message> key;
    bool is_key = false;
    if (!type.read_key(*data, &key.wire)) return "a sample without a key";
    const std::string wrong_key = check_key<Message>(key.wire, is_key);
    return wrong_key.empty() && !is_key ? "a key that is refused" : wrong_key;
}

template <typename Message>
std::string check_fields(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    ByteReader reader(bytes);
    WireFiller filler(reader);
    WireOf<Message> wire{};
    fields(filler, kNoMessage<Message>, wire);
    return check_sample<Message>(wire, 0, was_accepted);
}

Bytes input_of(Reading reading, Bytes bytes) {
    bytes.insert(bytes.begin(), static_cast<std::uint8_t>(reading));
    return bytes;
}

template <typename Message>
std::string check_wire_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    was_accepted = false;
    if (bytes.empty()) return "";
    const auto rest = bytes.subspan(1);
    switch (static_cast<Reading>(bytes[0] % kNumReadings)) {
        case Reading::kSample:
            return check_payload<Message>(rest, was_accepted);
        case Reading::kEndOfKey:
            return check_end_of_key<Message>(rest, was_accepted);
        case Reading::kFields:
            return check_fields<Message>(rest, was_accepted);
    }
    return "no reading";
}

template <typename Message>
std::vector<Bytes> wire_samples() {
    constexpr int kNumDrawn = 200;
    constexpr std::size_t kNumKept = 4;
    bus::testing::Random random(2);
    bus::WireScratch scratch;
    std::vector<Bytes> inputs;
    Bytes key;
    for (int i = 0; i < kNumDrawn; ++i) {
        const auto message = bus::testing::random_message<Message>(random);
        WireOf<Message> wire{};
        bus::to_wire(message, scratch, wire);
        inputs.push_back(
            input_of(Reading::kSample, cdr_type<Message>().payload_of(&wire, SDK_DATA)));
        key = input_of(Reading::kEndOfKey, cdr_type<Message>().payload_of(&wire, SDK_KEY));
    }
    std::stable_sort(inputs.begin(), inputs.end(), [](const auto& a, const auto& b) {
        return a.size() < b.size();
    });
    inputs.resize(kNumKept);
    inputs.push_back(key);
    inputs.push_back(input_of(Reading::kFields, {}));
    return inputs;
}

template <typename... Messages>
constexpr auto checks_of() {
    return std::array{WireCheck{
        bus::Topic<Messages>::kName, check_wire_bytes<Messages>, wire_samples<Messages>}...};
}

constexpr auto kChecks = checks_of<bus::SiteDescription,
                                   bus::SiteMesh,
                                   bus::CameraTexture,
                                   bus::CameraSilhouette,
                                   bus::SiteOrders,
                                   bus::ClockAnswer,
                                   bus::CameraNodeStatus,
                                   bus::RegionOrder,
                                   bus::RegionMeshes,
                                   bus::RegionNodeStatus,
                                   bus::SitePlacement,
                                   bus::SceneObject,
                                   bus::SoftBody,
                                   bus::SoftBodyState,
                                   bus::Scenery,
                                   bus::SceneState,
                                   bus::PersonProxy,
                                   bus::ObjectProxy,
                                   bus::SceneCommand,
                                   bus::SceneEdit,
                                   bus::EditResult,
                                   bus::SavedWorlds,
                                   bus::RoomRecordOrder,
                                   bus::RoomRecording,
                                   bus::SiteStatus,
                                   bus::WorldStatus,
                                   bus::ViewerStatus,
                                   bus::StreamFeedback,
                                   bus::Presence,
                                   bus::RevokedKeys>();

}  // namespace

std::span<const WireCheck> wire_checks() { return kChecks; }

}  // namespace atrium::test
