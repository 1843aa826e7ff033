#include "site_node/capture/aravis_setup.hpp"

#include "site_node/capture/network_interface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace atrium::capture {
namespace {

// No link carries larger GVSP packets (jumbo frames have 9000 bytes, loopback 65536).
constexpr int kMaxPacketBytes = 16384;

struct FormatName {
    ArvPixelFormat arv;
    image::PixelFormat format;
};
constexpr FormatName kFormats[] = {
    {ARV_PIXEL_FORMAT_MONO_8, image::PixelFormat::kMono8},
    {ARV_PIXEL_FORMAT_BAYER_RG_8, image::PixelFormat::kBayerRG},
    {ARV_PIXEL_FORMAT_BAYER_GR_8, image::PixelFormat::kBayerGR},
    {ARV_PIXEL_FORMAT_BAYER_GB_8, image::PixelFormat::kBayerGB},
    {ARV_PIXEL_FORMAT_BAYER_BG_8, image::PixelFormat::kBayerBG},
    {ARV_PIXEL_FORMAT_RGB_8_PACKED, image::PixelFormat::kRgb},
    {ARV_PIXEL_FORMAT_BGR_8_PACKED, image::PixelFormat::kBgr},
    {ARV_PIXEL_FORMAT_YUV_422_PACKED, image::PixelFormat::kUyvy},
    {ARV_PIXEL_FORMAT_YUV_422_YUYV_PACKED, image::PixelFormat::kYuyv},
};

tl::unexpected<Error> refused(const std::string& key, const std::string& reason) {
    return make_error(ErrorKind::kConfiguration, fmt::format("{}: {}", key, reason));
}

// Sets up one camera, step by step.
class Setup {
public:
    Setup(ArvCamera& camera, const SetupRequest& request, std::vector<std::string>& warnings)
        : camera_(camera), request_(request), warnings_(warnings) {}

    bool has(const char* feature) {
        return arv_camera_is_feature_available(&camera_, feature, error_.out()) && !error_.failed();
    }

    // Returns the first of `features` that the camera has; null: none.
    const char* first_of(std::initializer_list<const char*> features) {
        for (const char* feature : features) {
            if (has(feature)) return feature;
        }
        return nullptr;
    }

    Expected<void> pixel_format(CameraFormat& format) {
        const std::string& wanted = request_.settings.pixel_format;
        if (!wanted.empty()) {
            arv_camera_set_pixel_format_from_string(&camera_, wanted.c_str(), error_.out());
            if (error_.failed()) {
                return refused(
                    "pixel_format",
                    fmt::format("the camera refuses '{}' ({}); it has {}",
                                wanted,
                                error_.message(),
                                available(&arv_camera_dup_available_pixel_formats_as_strings)));
            }
        }
        format.arv_format = arv_camera_get_pixel_format(&camera_, error_.out());
        if (error_.failed()) return refused("pixel_format", error_.message());
        const char* name = arv_camera_get_pixel_format_as_string(&camera_, error_.out());
        auto known = pixel_format_of(format.arv_format, name == nullptr ? "unnamed" : name);
        if (!known) return tl::unexpected(known.error());
        format.format = *known;
        return {};
    }

    Expected<void> region(CameraFormat& format) {
        const bool is_any_size = request_.width == 0;
        const std::array<int, 4> whole =
            is_any_size ? whole_sensor() : std::array{0, 0, request_.width, request_.height};
        const std::array<int, 4> wanted = request_.settings.region_px.value_or(whole);
        if (!is_any_size && (wanted[2] != request_.width || wanted[3] != request_.height)) {
            return refused("region_px",
                           fmt::format("is {} x {}, but the rig needs {} x {}",
                                       wanted[2],
                                       wanted[3],
                                       request_.width,
                                       request_.height));
        }
        const bool has_offsets = has("OffsetX") && has("OffsetY");
        if (!has_offsets && (wanted[0] != 0 || wanted[1] != 0))
            return refused("region_px", "the camera has no OffsetX and OffsetY");
        const int offset = has_offsets ? 0 : -1;
        arv_camera_set_region(&camera_,
                              has_offsets ? wanted[0] : offset,
                              has_offsets ? wanted[1] : offset,
                              wanted[2],
                              wanted[3],
                              error_.out());
        const std::string problem = error_.failed() ? error_.message() : "";
        std::array<int, 4> now{};
        arv_camera_get_region(&camera_, &now[0], &now[1], &now[2], &now[3], error_.out());
        if (now != wanted) {
            return refused("region_px",
                           fmt::format("{} {} x {} pixels from ({}, {}), the camera "
                                       "gives {} x {} from ({}, {}){}{}",
                                       is_any_size ? "the site asks for" : "the rig needs",
                                       wanted[2],
                                       wanted[3],
                                       wanted[0],
                                       wanted[1],
                                       now[2],
                                       now[3],
                                       now[0],
                                       now[1],
                                       problem.empty() ? "" : ": ",
                                       problem));
        }
        format.width = wanted[2];
        format.height = wanted[3];
        return {};
    }

    Expected<void> exposure(CameraFormat&) {
        const double exposure_us = request_.settings.exposure_us;
        if (exposure_us <= 0.0) return {};
        if (arv_camera_is_exposure_auto_available(&camera_, error_.out()))
            arv_camera_set_exposure_time_auto(&camera_, ARV_AUTO_OFF, error_.out());
        arv_camera_set_exposure_time(&camera_, exposure_us, error_.out());
        if (error_.failed()) return refused("exposure_us", error_.message());
        return {};
    }

    Expected<void> gain(CameraFormat&) {
        const double gain_db = request_.settings.gain_db;
        if (gain_db < 0.0) return {};
        if (arv_camera_is_gain_auto_available(&camera_, error_.out()))
            arv_camera_set_gain_auto(&camera_, ARV_AUTO_OFF, error_.out());
        arv_camera_set_gain(&camera_, gain_db, error_.out());
        if (error_.failed()) return refused("gain_db", error_.message());
        return {};
    }

    Expected<void> white_balance(CameraFormat&) {
        const std::string& wanted = request_.settings.white_balance;
        if (wanted.empty()) return {};
        if (wanted == "off" || wanted == "auto-once") {
            arv_camera_set_string(
                &camera_, "BalanceWhiteAuto", wanted == "off" ? "Off" : "Once", error_.out());
            if (error_.failed()) return refused("white_balance", error_.message());
            return {};
        }
        const std::size_t comma = wanted.find(',');
        double red = 0.0;
        double blue = 0.0;
        const char* const begin = wanted.data();
        const char* const end = begin + wanted.size();
        if (comma == std::string::npos ||
            std::from_chars(begin, begin + comma, red).ptr != begin + comma ||
            std::from_chars(begin + comma + 1, end, blue).ptr != end || red <= 0.0 || blue <= 0.0) {
            return refused("white_balance",
                           fmt::format("must be \"off\", \"auto-once\" or the gains of red and "
                                       "blue, as in \"1.8,1.4\"; got '{}'",
                                       wanted));
        }
        if (has("BalanceWhiteAuto"))
            arv_camera_set_string(&camera_, "BalanceWhiteAuto", "Off", error_.out());
        for (const auto& [name, ratio] : {std::pair{"Red", red}, std::pair{"Blue", blue}}) {
            arv_camera_set_string(&camera_, "BalanceRatioSelector", name, error_.out());
            if (!error_.failed())
                arv_camera_set_float(&camera_, "BalanceRatio", ratio, error_.out());
            if (error_.failed()) return refused("white_balance", error_.message());
        }
        return {};
    }

    Expected<void> trigger(CameraFormat&) {
        arv_camera_set_acquisition_mode(&camera_, ARV_ACQUISITION_MODE_CONTINUOUS, error_.out());
        switch (request_.trigger) {
            case TriggerMode::kFreeRun:
                return free_run();
            case TriggerMode::kSoftware:
                return set_trigger("Software");
            case TriggerMode::kExternal:
                break;
        }
        if (!request_.settings.trigger_source.empty())
            return set_trigger(request_.settings.trigger_source);
        guint count = 0;
        const char** sources =
            arv_camera_dup_available_trigger_sources(&camera_, &count, error_.out());
        std::string line;
        for (guint i = 0; i < count && line.empty(); ++i) {
            if (std::string(sources[i]).rfind("Line", 0) == 0) line = sources[i];
        }
        g_free(sources);
        if (line.empty())
            return refused("capture.trigger", "the camera has no input line for a trigger");
        return set_trigger(line);
    }

    // Cameras with a common clock have comparable times.
    bool ptp() {
        const char* const feature = first_of({"PtpEnable", "GevIEEE1588"});
        if (feature != nullptr) {
            arv_camera_set_boolean(&camera_, feature, TRUE, error_.out());
            if (!error_.failed()) return true;
        }
        warnings_.push_back(
            "has no PTP: its own clock is mapped to the site clock by the arrival of its pictures");
        return false;
    }

    Expected<void> packets(CameraFormat& format) {
        if (!arv_camera_is_gv_device(&camera_)) return {};
        const int wanted = request_.settings.packet_size;
        gint64 min = 0;
        gint64 max = 0;
        arv_camera_get_integer_bounds(&camera_, "GevSCPSPacketSize", &min, &max, error_.out());
        const bool is_bounded = !error_.failed() && max > 0;
        if (wanted != 0 && is_bounded && (wanted < min || wanted > max)) {
            return refused(
                "packet_size",
                fmt::format("the camera accepts {} to {} bytes, got {}", min, max, wanted));
        }
        const int size = wanted != 0 ? wanted : largest_packet(is_bounded ? max : kMaxPacketBytes);
        // its own search may end above what the interface allows
        arv_camera_gv_set_packet_size_adjustment(&camera_, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
        arv_camera_gv_set_packet_size(&camera_, size, error_.out());
        format.packet_bytes =
            static_cast<int>(arv_camera_gv_get_packet_size(&camera_, GErrorSlot().out()));
        if (wanted != 0 && (error_.failed() || format.packet_bytes != wanted)) {
            return refused("packet_size",
                           fmt::format("the camera has {} bytes instead of {}{}{}",
                                       format.packet_bytes,
                                       wanted,
                                       error_.failed() ? ": " : "",
                                       error_.failed() ? error_.message() : ""));
        }
        if (request_.settings.packet_delay_ns < 0) return {};
        arv_camera_gv_set_packet_delay(&camera_, request_.settings.packet_delay_ns, error_.out());
        if (error_.failed()) return refused("packet_delay_ns", error_.message());
        return {};
    }

    Expected<void> payload(CameraFormat& format) {
        format.payload_bytes = arv_camera_get_payload(&camera_, error_.out());
        if (error_.failed() || format.payload_bytes == 0) {
            return make_error(ErrorKind::kUnavailable,
                              fmt::format("the camera does not report the size of its pictures: {}",
                                          error_.message()));
        }
        return {};
    }

private:
    // Without its borders, which bound the size while there are any.
    std::array<int, 4> whole_sensor() {
        if (has("OffsetX") && has("OffsetY")) {
            arv_camera_set_integer(&camera_, "OffsetX", 0, error_.out());
            arv_camera_set_integer(&camera_, "OffsetY", 0, error_.out());
        }
        std::array<int, 4> region{};
        int least = 0;
        arv_camera_get_width_bounds(&camera_, &least, &region[2], error_.out());
        arv_camera_get_height_bounds(&camera_, &least, &region[3], error_.out());
        return region;
    }

    std::string available(const char** (*list)(ArvCamera*, guint*, GError**)) {
        guint count = 0;
        GErrorSlot error;
        const char** names = list(&camera_, &count, error.out());
        std::string text;
        for (guint i = 0; i < count; ++i) text += (i == 0 ? "" : ", ") + std::string(names[i]);
        g_free(names);
        return text;
    }

    Expected<void> set_trigger(const std::string& source) {
        arv_camera_set_trigger(&camera_, source.c_str(), error_.out());
        if (error_.failed()) {
            return refused("capture.trigger",
                           fmt::format("the camera refuses the source '{}' ({}); it has {}",
                                       source,
                                       error_.message(),
                                       available(&arv_camera_dup_available_trigger_sources)));
        }
        return {};
    }

    Expected<void> free_run() {
        arv_camera_clear_triggers(&camera_, error_.out());
        if (!arv_camera_is_frame_rate_available(&camera_, error_.out())) {
            warnings_.push_back("has no adjustable frame rate");
            return {};
        }
        arv_camera_set_frame_rate(&camera_, request_.rate_hz, error_.out());
        if (error_.failed()) return refused("capture.rate_hz", error_.message());
        return {};
    }

    int largest_packet(gint64 max) {
        int size = std::min(mtu_towards_camera(), kMaxPacketBytes);
        size = static_cast<int>(std::min<gint64>(size, max));
        const auto step =
            arv_camera_get_integer_increment(&camera_, "GevSCPSPacketSize", error_.out());
        return error_.failed() || step <= 1 ? size : size - size % static_cast<int>(step);
    }

    int mtu_towards_camera() {
        auto* const device = ARV_GV_DEVICE(arv_camera_get_device(&camera_));
        GSocketAddress* const own = arv_gv_device_get_interface_address(device);
        char* const text =
            g_inet_address_to_string(g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(own)));
        const int mtu = mtu_of_interface(text);
        g_free(text);
        return mtu;
    }

    ArvCamera& camera_;
    const SetupRequest& request_;
    std::vector<std::string>& warnings_;
    GErrorSlot error_;
};

}  // namespace

Expected<image::PixelFormat> pixel_format_of(ArvPixelFormat format, const std::string& name) {
    for (const FormatName& known : kFormats) {
        if (known.arv == format) return known.format;
    }
    std::string names;
    for (const std::string& usable : camera_pixel_formats())
        names += (names.empty() ? "" : ", ") + usable;
    return refused("pixel_format",
                   fmt::format("the camera sends '{}'; must be one of {}", name, names));
}

Expected<CameraFormat> set_up_camera(ArvCamera& camera,
                                     const SetupRequest& request,
                                     std::vector<std::string>& warnings) {
    Setup setup(camera, request, warnings);
    CameraFormat format;
    // format and region first: the possible rates and exposures depend on them
    for (const auto step : {&Setup::pixel_format,
                            &Setup::region,
                            &Setup::exposure,
                            &Setup::gain,
                            &Setup::white_balance,
                            &Setup::trigger,
                            &Setup::packets,
                            &Setup::payload}) {
        if (auto done = (setup.*step)(format); !done) return tl::unexpected(done.error());
    }
    if (request.trigger == TriggerMode::kFreeRun) format.has_ptp = setup.ptp();
    return format;
}

}  // namespace atrium::capture
