#include "core/bus/raw_samples.hpp"

#include "core/bus/cdr.hpp"
#include "core/bus/endpoints.hpp"
#include "core/bus/loan.hpp"

#include <array>
#include <type_traits>

namespace atrium::bus {
namespace {

// The wire struct of a sample from bytes, or of Cyclone.
template <typename Message>
class Wire {
public:
    Wire() = default;
    Wire(const Wire&) = delete;
    Wire& operator=(const Wire&) = delete;
    ~Wire() { free_wire(Topic<Message>::kDescriptor, &wire_); }

    Expected<void> read(std::span<const std::byte> cdr) {
        return wire_of(Topic<Message>::kDescriptor, cdr, &wire_);
    }
    const WireOf<Message>& operator*() const { return wire_; }

private:
    WireOf<Message> wire_{};
};

class KeyText : public FieldVisitor<KeyText> {
public:
    void field(auto&&...) {}
    void part(auto&&...) {}
    template <typename Member>
    void key(std::string_view /*name*/, const Member& member, const auto&... /*more*/) {
        if (!text_.empty()) text_ += '/';
        if constexpr (std::is_same_v<Member, std::string>)
            text_ += member;
        else if constexpr (std::is_enum_v<Member>)
            text_ += std::to_string(static_cast<int>(member));
        else
            text_ += std::to_string(member);
    }
    std::string take() { return std::move(text_); }

private:
    std::string text_;
};

template <typename Message>
std::string key_text(const Message& message) {
    KeyText text;
    fields(text, message, kNoWire<WireOf<Message>>);
    return text.take();
}

template <typename Message>
std::vector<std::byte> cdr_of_key(const Message& key) {
    WireOf<Message> wire{};
    key_to_wire(key, wire);
    return cdr_of(Topic<Message>::kDescriptor, &wire);
}

template <typename Message>
class RawReaderOf final : public RawReader {
public:
    RawReaderOf(Reader<Message> reader, dds_entity_t entity)
        : reader_(std::move(reader)), entity_(entity) {}

    TakeReport take(const std::function<void(const RawSample&)>& on_sample) override {
        TakeReport report;
        for (std::size_t batch = 0; batch < kMaxBatchesPerTake; ++batch) {
            const Loan loan(entity_);
            for (int i = 0; i < loan.size(); ++i) {
                const dds_sample_info_t& info = loan.info(i);
                if (info.valid_data) {
                    if (const auto ended = lives_.ended_before(info))
                        end(loan.sample(i), info, *ended, on_sample);
                    const auto cdr = cdr_of(Topic<Message>::kDescriptor, loan.sample(i));
                    on_sample({RawKind::kSample, when_written(info), cdr});
                    ++report.num_taken;
                }
                if (is_end_of_instance(info)) {
                    lives_.gone(info);
                    const bool is_disposed =
                        info.instance_state == DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE;
                    end(loan.sample(i),
                        info,
                        is_disposed ? Ending::kDisposed : Ending::kLost,
                        on_sample);
                }
            }
            if (loan.size() < static_cast<int>(kTakeBatch)) break;
        }
        return report;
    }
    void add_to(Waiter& waiter) const override { waiter.add(reader_); }
    int num_writers() const override { return reader_.num_writers(); }

private:
    static void end(const void* sample,
                    const dds_sample_info_t& info,
                    Ending how,
                    const std::function<void(const RawSample&)>& on_sample) {
        const auto key = key_from_wire<Message>(*static_cast<const WireOf<Message>*>(sample));
        if (!key) return;  // of an instance that nobody took a sample of either
        const auto cdr = cdr_of_key(*key);
        on_sample({how == Ending::kDisposed ? RawKind::kDisposed : RawKind::kLost,
                   when_written(info),
                   cdr});
    }

    Reader<Message> reader_;
    dds_entity_t entity_;  // of reader_
    Lives lives_;
};

template <typename Message>
class RawWriterOf final : public RawWriter {
public:
    RawWriterOf(Writer<Message> writer, dds_entity_t entity)
        : writer_(std::move(writer)), entity_(entity) {}

    Expected<void> write(const RawSample& sample) override {
        Wire<Message> wire;
        if (auto read = wire.read(sample.cdr); !read) return named(std::move(read.error()));
        const dds_time_t written = std::max<dds_time_t>(sample.written.ns, 0);
        dds_return_t result = DDS_RETCODE_OK;
        if (sample.kind == RawKind::kSample) {
            if (auto message = from_wire<Message>(*wire); !message)
                return named(std::move(message.error()));
            result = dds_write_ts(entity_, &*wire, written);
        } else {
            if (auto key = key_from_wire<Message>(*wire); !key)
                return named(std::move(key.error()));
            if (sample.kind == RawKind::kDisposed)
                result = dds_dispose_ts(entity_, &*wire, written);
            if (result >= 0) result = dds_unregister_instance_ts(entity_, &*wire, written);
            // the instance ended before, or never was
            if (result == DDS_RETCODE_PRECONDITION_NOT_MET) result = DDS_RETCODE_OK;
        }
        if (result < 0)
            return named(
                {result == DDS_RETCODE_TIMEOUT ? ErrorKind::kUnavailable : ErrorKind::kInternal,
                 dds_strretcode(result)});
        return {};
    }
    int num_readers() const override { return writer_.num_readers(); }

private:
    static tl::unexpected<Error> named(Error error) {
        return make_error(error.kind, fmt::format("{}: {}", Topic<Message>::kName, error.message));
    }

    Writer<Message> writer_;
    dds_entity_t entity_;  // of writer_
};

}  // namespace

// A friend of Reader and Writer: has their entities.
template <typename Message>
class RawTopicOf final : public RawTopic {
public:
    std::string_view name() const override { return Topic<Message>::kName; }
    std::string_view type_name() const override { return Topic<Message>::kDescriptor.m_typename; }
    std::string_view qos_class() const override { return Topic<Message>::kProfile; }

    Expected<std::unique_ptr<RawReader>> reader(const Participant& participant) const override {
        auto reader = Reader<Message>::create(participant);
        if (!reader) return tl::unexpected(reader.error());
        const dds_entity_t entity = reader->impl_->reader.get();
        return std::make_unique<RawReaderOf<Message>>(std::move(*reader), entity);
    }
    Expected<std::unique_ptr<RawWriter>> writer(const Participant& participant) const override {
        auto writer = Writer<Message>::create(participant);
        if (!writer) return tl::unexpected(writer.error());
        const dds_entity_t entity = writer->impl_->writer.get();
        return std::make_unique<RawWriterOf<Message>>(std::move(*writer), entity);
    }
    Expected<std::string> key_of(const RawSample& sample) const override {
        const auto found = key(sample);
        if (!found) return tl::unexpected(found.error());
        return key_text(*found);
    }
    Expected<std::vector<std::byte>> key_cdr(const RawSample& sample) const override {
        const auto found = key(sample);
        if (!found) return tl::unexpected(found.error());
        return cdr_of_key(*found);
    }

private:
    static Expected<Message> key(const RawSample& sample) {
        Wire<Message> wire;
        if (auto read = wire.read(sample.cdr); !read) return tl::unexpected(read.error());
        return key_from_wire<Message>(*wire);
    }
};

namespace {

template <typename... Messages>
struct TopicsOf {
    static std::span<const RawTopic* const> all() {
        static const std::tuple<RawTopicOf<Messages>...> topics;
        static const std::array<const RawTopic*, sizeof...(Messages)> list = std::apply(
            [](const auto&... topic) {
                return std::array<const RawTopic*, sizeof...(Messages)>{&topic...};
            },
            topics);
        return list;
    }
};

}  // namespace

std::span<const RawTopic* const> raw_topics() {
    return TopicsOf<SiteDescription,
                    SiteMesh,
                    CameraTexture,
                    SitePlacement,
                    SceneObject,
                    SoftBody,
                    SoftBodyState,
                    Scenery,
                    SceneState,
                    PersonProxy,
                    ObjectProxy,
                    SceneCommand,
                    SceneEdit,
                    EditResult,
                    SavedWorlds,
                    RoomRecordOrder,
                    RoomRecording,
                    SiteStatus,
                    WorldStatus,
                    ViewerStatus,
                    CameraNodeStatus,
                    RegionNodeStatus,
                    StreamFeedback,
                    Presence>::all();
}

const RawTopic* find_raw_topic(std::string_view name) {
    for (const RawTopic* topic : raw_topics()) {
        if (topic->name() == name) return topic;
    }
    return nullptr;
}

template <typename Message>
std::string_view topic_name() {
    return Topic<Message>::kName;
}

template <typename Message>
Expected<Message> from_raw(const RawSample& sample) {
    Wire<Message> wire;
    if (auto read = wire.read(sample.cdr); !read) return tl::unexpected(read.error());
    return sample.kind == RawKind::kSample ? from_wire<Message>(*wire)
                                           : key_from_wire<Message>(*wire);
}

template <typename Message>
std::vector<std::byte> to_cdr(const Message& message) {
    WireScratch scratch;
    WireOf<Message> wire{};
    to_wire(message, scratch, wire);
    return cdr_of(Topic<Message>::kDescriptor, &wire);
}

#define ATRIUM_RAW(Message)                                         \
    template std::string_view topic_name<Message>();                \
    template Expected<Message> from_raw<Message>(const RawSample&); \
    template std::vector<std::byte> to_cdr<Message>(const Message&)
ATRIUM_RAW(SiteDescription);
ATRIUM_RAW(SiteMesh);
ATRIUM_RAW(CameraTexture);
ATRIUM_RAW(SitePlacement);
ATRIUM_RAW(SceneObject);
ATRIUM_RAW(SoftBody);
ATRIUM_RAW(SoftBodyState);
ATRIUM_RAW(Scenery);
ATRIUM_RAW(SceneState);
ATRIUM_RAW(PersonProxy);
ATRIUM_RAW(ObjectProxy);
ATRIUM_RAW(SceneCommand);
ATRIUM_RAW(SceneEdit);
ATRIUM_RAW(EditResult);
ATRIUM_RAW(SavedWorlds);
ATRIUM_RAW(RoomRecordOrder);
ATRIUM_RAW(RoomRecording);
ATRIUM_RAW(SiteStatus);
ATRIUM_RAW(WorldStatus);
ATRIUM_RAW(ViewerStatus);
ATRIUM_RAW(CameraNodeStatus);
ATRIUM_RAW(RegionNodeStatus);
ATRIUM_RAW(StreamFeedback);
ATRIUM_RAW(Presence);
#undef ATRIUM_RAW

}  // namespace atrium::bus
