#include "core/bus/checks.hpp"

#include "core/bus/fields.hpp"
#include "core/bus/names.hpp"
#include "core/bus/wire.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

namespace atrium::bus {

namespace {

/// Records the first field of a message outside its limits. Formats text only for an error.
class Checker : public FieldVisitor<Checker> {
public:
    template <typename Member, typename Wire, typename Limits>
    void field(std::string_view name, const Member& member, const Wire&, const Limits& limits) {
        check(name, member, limits);
        if constexpr (kIsVector<Member> && !std::is_same_v<Member, Bytes>) {
            using Element = typename Member::value_type;
            if constexpr (std::is_class_v<Element> && kGroupSize<Element> == 0) {
                for (const Element& element : member)
                    fields(*this, element, kNoWire<ElementOf<Wire>>);
            }
        }
    }
    void rule(std::string_view name, bool holds, std::string_view why) {
        if (!holds) fail(name, why);
    }
    Expected<void> result() const {
        if (!fault_.empty()) return make_error(ErrorKind::kInvalidData, fault_);
        return {};
    }

private:
    using Bytes = std::vector<std::uint8_t>;

    template <std::integral T>
    void check(std::string_view, T, Unlimited) {}
    template <std::integral T, std::size_t N>
    void check(std::string_view, const std::array<T, N>&, Unlimited) {}

    // Every comparison of numbers is false for NaN, which thus fails the check.
    void check(std::string_view name, double value, Range range) {
        if (!(value >= range.low && value <= range.high))
            fail(name, fmt::format("must be in [{}, {}], got {}", range.low, range.high, value));
    }
    void check(std::string_view name, const Eigen::Vector3d& vector, Range range) {
        for (const double component : vector) check(name, component, range);
    }
    template <std::size_t N>
    void check(std::string_view name, const std::array<double, N>& values, Range range) {
        for (const double value : values) check(name, value, range);
    }
    void check(std::string_view name, double value, const RangeOrNone& limits) {
        if (value != limits.none) check(name, value, limits.range);
    }
    void check(std::string_view name, double value, Positive limit) {
        if (!(value > 0.0 && value <= limit.high))
            fail(name, fmt::format("must be in (0, {}], got {}", limit.high, value));
    }
    void check(std::string_view name, const Eigen::Vector3d& size, Sizes limit) {
        // A plane has only two sizes. Models and soft objects may be flat.
        const int num_sizes = limit.shape == Shape::kPlane ? 2 : 3;
        for (int i = 0; i < num_sizes && limit.shape < Shape::kConvex; ++i)
            check(name, size[i], Positive{kMaxCoordinate_m});
        check(name, size, within(kMaxCoordinate_m));
        if (limit.shape >= Shape::kConvex && size.minCoeff() < 0.0)
            fail(name, "must not be negative");
    }
    void check(std::string_view name, Timestamp value, Unlimited) {
        if (value.ns < 0 || value.ns > kMaxTime_ns)
            fail(name, fmt::format("must be in [0, 2^62] ns, got {}", value.ns));
    }
    void check(std::string_view name, std::chrono::nanoseconds value, Unlimited none) {
        check(name, Timestamp{value.count()}, none);
    }
    void check(std::string_view name, const LatencySummary& value, Unlimited) {
        // negative if the capturing host's clock is ahead of the measuring host's
        check(name, value.median_ms, within(kMaxStatistic));
        check(name, value.p99_ms, within(kMaxStatistic));
    }
    void check(std::string_view name, const geometry::RigidTransform& pose, Unlimited) {
        if (!is_unit(pose.rotation)) fail(name, "rotation must be a unit quaternion");
        check(name, pose.translation, within(kMaxCoordinate_m));
    }
    template <typename Enumerator>
    void check(std::string_view name, Enumerator value, Last<Enumerator> limit) {
        if (value > limit.last)
            fail(name, fmt::format("unknown value {}", static_cast<unsigned>(value)));
    }
    void check(std::string_view name, const std::string& text, Text kind) {
        const bool may_be_empty = kind == Text::kNameOrNone || kind == Text::kModelFileOrNone;
        if (text.empty() && may_be_empty) return;
        if (kind == Text::kLine) {
            if (!is_valid_line(text)) fail(name, "must be at most 255 printable ASCII characters");
            return;
        }
        if (kind == Text::kName || kind == Text::kNameOrNone) {
            if (!is_valid_name(text)) fail(name, "must have 1 to 63 characters of [A-Za-z0-9_.-]");
        } else if (!is_valid_model_file(text)) {
            fail(name,
                 "must be a relative path of 1 to 127 characters of [A-Za-z0-9_.-/] without a "
                 "component that is empty or begins with a dot");
        }
    }

    void check(std::string_view name, std::size_t count, AtMost limit) {
        if (count > limit.max) fail(name, fmt::format("at most {}, got {}", limit.max, count));
    }
    template <typename Element>
    void check(std::string_view name, const std::vector<Element>& elements, AtMost limit) {
        check(name, elements.size(), limit);
    }
    void check(std::string_view name, const Bytes& bytes, AtMost limit) {
        if (bytes.size() > limit.max) check(std::string(name) + " bytes", bytes.size(), limit);
    }
    template <std::size_t N>
    void check(std::string_view name,
               const std::vector<std::array<std::uint16_t, N>>& groups,
               const Indices& limits) {
        check(name, groups.size(), AtMost{limits.max});
        for (const auto& group : groups) {
            for (const std::uint16_t index : group)
                if (index >= limits.end)
                    fail(name, fmt::format("index {} of {}", index, limits.end));
        }
    }
    template <typename Element>
    void check(std::string_view name, const std::vector<Element>& elements, EachOrNone limit) {
        if (!elements.empty() && elements.size() != limit.max)
            fail(name, fmt::format("must be {} or none, got {}", limit.max, elements.size()));
    }
    void check(std::string_view name, const std::vector<std::uint32_t>& sizes, ContourSizes limit) {
        check(name, sizes.size(), AtMost{limit.max});
        if (limit.counts != nullptr) expect_sum(name, *limit.counts, sizes.size());
    }
    void check(std::string_view name,
               const std::vector<std::uint32_t>& counts,
               ContourCounts limit) {
        if (counts.size() != limit.num)
            fail(name, fmt::format("must be {}, got {}", limit.num, counts.size()));
    }
    void check(std::string_view name, const std::vector<std::uint32_t>& sizes, PartSizes limit) {
        check(name, sizes.size(), AtMost{limit.max});
        if (!sizes.empty()) expect_sum(name, sizes, limit.total);
    }
    void check(std::string_view name, const std::vector<RegionHull>& regions, MeshesOf limit) {
        check(name, regions.size(), AtMost{limit.max});
        std::uint64_t seen = 0;       // one bit per region
        std::uint64_t num_bytes = 0;  // of some 32-bit numbers: cannot overflow
        static_assert(kMaxRegions == 64);
        for (const RegionHull& hull : regions) {
            fields(*this, hull, kNoWire<atrium_RegionHull>);  // its own limits come first
            const std::uint64_t bit = std::uint64_t{1} << (hull.region % kMaxRegions);
            if ((seen & bit) != 0) fail(name, "names a region twice");
            seen |= bit;
            num_bytes += hull.num_bytes;
            if ((hull.num_bytes > 0) != (hull.outcome == RegionOutcome::kMesh))
                fail(name, "has a mesh without bytes, or bytes without a mesh");
        }
        if (num_bytes != limit.total)
            fail(name, fmt::format("the sizes say {}, there are {}", num_bytes, limit.total));
    }
    void check(std::string_view name,
               const std::vector<std::array<double, 2>>& vertices,
               const Vertices& limits) {
        check(name, vertices.size(), AtMost{limits.max});
        expect_sum(name, limits.sizes, vertices.size());
        for (const auto& vertex : vertices) check(name, vertex, within(kMaxVertex_px));
    }
    void check(std::string_view name, const std::vector<std::uint32_t>& cameras, CameraSet) {
        std::uint64_t seen = 0;  // one bit per camera
        static_assert(kMaxCamerasPerSite == 64);
        for (const std::uint32_t camera : cameras) {
            const std::uint64_t bit = camera < kMaxCamerasPerSite ? std::uint64_t{1} << camera : 0;
            if (bit == 0) fail(name, "index out of range");
            if ((seen & bit) != 0) fail(name, "names a camera twice");
            seen |= bit;
        }
    }

    void expect_sum(std::string_view name,
                    const std::vector<std::uint32_t>& sizes,
                    std::size_t sum) {
        std::uint64_t named = 0;  // of some thousand 32-bit numbers: cannot overflow
        for (const std::uint32_t size : sizes) named += size;
        if (named != sum) fail(name, fmt::format("the sizes say {}, there are {}", named, sum));
    }
    void fail(std::string_view name, std::string_view why) {
        if (fault_.empty()) fault_ = fmt::format("{}: {}", name, why);
    }

    std::string fault_;
};

}  // namespace

template <typename Message>
Expected<void> check(const Message& message) {
    Checker checker;
    fields(checker, message, kNoWire<WireOf<Message>>);
    return checker.result();
}

template Expected<void> check(const SiteDescription&);
template Expected<void> check(const SiteMesh&);
template Expected<void> check(const CameraTexture&);
template Expected<void> check(const CameraSilhouette&);
template Expected<void> check(const SiteOrders&);
template Expected<void> check(const ClockAnswer&);
template Expected<void> check(const CameraNodeStatus&);
template Expected<void> check(const RegionOrder&);
template Expected<void> check(const RegionMeshes&);
template Expected<void> check(const RegionNodeStatus&);
template Expected<void> check(const SitePlacement&);
template Expected<void> check(const SceneObject&);
template Expected<void> check(const SoftBody&);
template Expected<void> check(const SoftBodyState&);
template Expected<void> check(const Scenery&);
template Expected<void> check(const SceneState&);
template Expected<void> check(const PersonProxy&);
template Expected<void> check(const ObjectProxy&);
template Expected<void> check(const SceneCommand&);
template Expected<void> check(const SceneEdit&);
template Expected<void> check(const EditResult&);
template Expected<void> check(const SavedWorlds&);
template Expected<void> check(const RoomRecordOrder&);
template Expected<void> check(const RoomRecording&);
template Expected<void> check(const SiteStatus&);
template Expected<void> check(const WorldStatus&);
template Expected<void> check(const ViewerStatus&);
template Expected<void> check(const StreamFeedback&);
template Expected<void> check(const Presence&);
template Expected<void> check(const RevokedKeys&);

}  // namespace atrium::bus
