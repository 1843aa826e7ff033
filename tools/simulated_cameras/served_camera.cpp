#include "tools/simulated_cameras/served_camera.hpp"

#include "core/app/log.hpp"
#include "tools/simulated_cameras/sensor.hpp"
#include "tools/simulated_cameras/stamp.hpp"

#include <arv.h>
#include <fmt/format.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace atrium::simulated_cameras {
namespace {

using image::PixelFormat;

// How often a camera checks for a software trigger.
constexpr double kTriggerPolls_hz = 200.0;

// Aravis' camera sleeps whole milliseconds and spins for the rest, up to one per picture. This
// timer slack lets the kernel wake its thread later, which leaves little to spin.
constexpr unsigned long kTimerSlack_ns = 970'000;

// Sets the timer slack that threads started during its lifetime inherit.
class TimerSlack {
public:
    TimerSlack() : former_(prctl(PR_GET_TIMERSLACK)) { prctl(PR_SET_TIMERSLACK, kTimerSlack_ns); }
    TimerSlack(const TimerSlack&) = delete;
    TimerSlack& operator=(const TimerSlack&) = delete;
    ~TimerSlack() {
        if (former_ > 0) prctl(PR_SET_TIMERSLACK, static_cast<unsigned long>(former_));
    }

private:
    int former_;
};

ArvPixelFormat to_genicam(PixelFormat format) {
    switch (format) {
        case PixelFormat::kBayerRG:
            return ARV_PIXEL_FORMAT_BAYER_RG_8;
        case PixelFormat::kBayerGR:
            return ARV_PIXEL_FORMAT_BAYER_GR_8;
        case PixelFormat::kBayerGB:
            return ARV_PIXEL_FORMAT_BAYER_GB_8;
        case PixelFormat::kBayerBG:
            return ARV_PIXEL_FORMAT_BAYER_BG_8;
        case PixelFormat::kRgb:
            return ARV_PIXEL_FORMAT_RGB_8_PACKED;
        default:
            return ARV_PIXEL_FORMAT_MONO_8;
    }
}

// Returns the GenICam name of a format, or its number in hexadecimal if no simulated camera has it.
std::string name_of(ArvPixelFormat genicam_format) {
    for (const std::string& name : pixel_format_names()) {
        const auto format = find_pixel_format(name);
        if (format && to_genicam(*format) == genicam_format) return name;
    }
    return fmt::format("{:#x}", genicam_format);
}

}  // namespace

ServedCamera::ServedCamera(std::size_t index,
                           CameraIdentity identity,
                           bool stamp,
                           const CameraFaults& faults,
                           SharedServerState& state)
    : index_(index),
      identity_(std::move(identity)),
      stamp_(stamp),
      faults_(faults),
      state_(state) {}

ServedCamera::~ServedCamera() { stop(); }

Expected<void> ServedCamera::start() {
    is_leaving_ = false;
    const TimerSlack slack;
    device_ = arv_gv_fake_camera_new(identity_.address.c_str(), identity_.serial.c_str());
    if (!arv_gv_fake_camera_is_running(device_)) {
        stop();
        return make_error(
            ErrorKind::kUnavailable,
            fmt::format("camera {}: cannot listen on {}, port 3956: no interface has that address, "
                        "or another camera uses it",
                        identity_.name,
                        identity_.address));
    }
    const geometry::PinholeCamera& intrinsics = state_.shown.rig.cameras[index_].intrinsics;
    registers_ = ARV_FAKE_CAMERA(g_object_ref(arv_gv_fake_camera_get_fake_camera(device_)));
    const auto set = [&](guint32 address, double value) {
        arv_fake_camera_write_register(
            registers_, address, static_cast<guint32>(std::lround(value)));
    };
    // pictures have even sides; cameras of a rig need not
    const int width = intrinsics.width & ~1;
    const int height = intrinsics.height & ~1;
    set(ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, width);
    set(ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, height);
    set(ARV_FAKE_CAMERA_REGISTER_WIDTH, width);
    set(ARV_FAKE_CAMERA_REGISTER_HEIGHT, height);
    set(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, to_genicam(state_.shown.format));
    set(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US, 1e6 / state_.shown.rig.rate_hz);
    arv_fake_camera_set_trigger_frequency(registers_, kTriggerPolls_hz);
    arv_fake_camera_set_fill_pattern(
        registers_,
        [](ArvBuffer* buffer, void* self, guint32, guint32, ArvPixelFormat) {
            static_cast<ServedCamera*>(self)->fill(buffer);
        },
        this);
    g_object_set(device_, "gvsp-lost-ratio", faults_.lost_share, nullptr);
    return {};
}

void ServedCamera::stop() {
    if (device_ == nullptr) return;
    {
        const std::lock_guard lock(mutex_);
        is_leaving_ = true;
    }
    wake_.notify_all();
    g_object_unref(device_);  // ends its thread and closes its sockets
    device_ = nullptr;
    g_clear_object(&registers_);
}

// Free-running cameras expose at the ticks, however late this thread wakes. If it is too late to be
// distinguished from early, and for the first picture of a stream, which Aravis sends at once,
// waits for the next tick.
TriggerNumbers::Trigger ServedCamera::free_trigger(std::int64_t now_us, std::int64_t period_us) {
    const auto trigger = TriggerNumbers::free_running(now_us, period_us);
    if (now_us - trigger.time_us <= period_us / 4) return trigger;
    if (!hold_back(std::chrono::microseconds(trigger.time_us + period_us - now_us))) return trigger;
    return TriggerNumbers::free_running(trigger.time_us + period_us, period_us);
}

// Called on the thread of the fake camera, which sends the picture afterwards.
void ServedCamera::fill(ArvBuffer* buffer) {
    const auto now_us = static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer)) / 1000;
    guint32 period_us = 0;
    arv_fake_camera_read_register(
        registers_, ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US, &period_us);
    if (period_us == 0) period_us = 1'000'000;  // as in Aravis
    const bool is_free = arv_fake_camera_is_in_free_running_mode(registers_) != FALSE;
    const TriggerNumbers::Trigger trigger =
        is_free ? free_trigger(now_us, period_us)
                : state_.triggers.software(index_, now_us, period_us);
    std::size_t ignored = 0;  // Aravis returns 0; the memory has the size of the client's region
    auto* out =
        static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &ignored)));
    const bool is_ours = copy_region(state_.schedule.at(trigger.time_us), buffer, out);
    if (is_ours && stamp_) {
        write_stamp({static_cast<std::uint8_t>(index_), trigger.number},
                    state_.shown.format == PixelFormat::kRgb ? 3 : 1,
                    arv_buffer_get_image_width(buffer),
                    arv_buffer_get_image_height(buffer),
                    out);
    }
    const std::int64_t shutter_ns = 1000 * (is_free ? trigger.time_us : now_us);
    arv_buffer_set_timestamp(
        buffer,
        static_cast<guint64>(std::max<std::int64_t>(0, shutter_ns + faults_.clock_offset.count())));
    hold_back(faults_.delay);
    ++num_sent_;
    state_.on_picture();
}

// Returns false, with a grey picture, if the client requests a format or region that this camera
// lacks.
bool ServedCamera::copy_region(const ShowSchedule::Choice& choice,
                               ArvBuffer* buffer,
                               std::uint8_t* out) {
    const std::span<const std::uint8_t> picture =
        picture_of(state_.shown, index_, choice, rendered_picture_);
    const geometry::PinholeCamera& sensor = state_.shown.rig.cameras[index_].intrinsics;
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
    arv_buffer_get_image_region(buffer, &x, &y, &width, &height);
    const ArvPixelFormat format = arv_buffer_get_image_pixel_format(buffer);
    const bool fits =
        x >= 0 && y >= 0 && x + width <= (sensor.width & ~1) && y + height <= (sensor.height & ~1);
    if (format != to_genicam(state_.shown.format) || !fits) {
        const std::size_t num_bytes = static_cast<std::size_t>(width) *
                                      static_cast<std::size_t>(height) *
                                      ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format) / 8;
        std::memset(out, 128, num_bytes);
        const std::optional<std::string> line =
            grey_.look(identity_.name,
                       {width, height, x, y, name_of(format)},
                       {sensor.width & ~1,
                        sensor.height & ~1,
                        0,
                        0,
                        name_of(to_genicam(state_.shown.format))});
        if (line) app::log::warn("{}", *line);
        return false;
    }
    const std::size_t from_stride = image::row_bytes(state_.shown.format, sensor.width & ~1);
    const std::size_t to_stride = image::row_bytes(state_.shown.format, width);
    const std::uint8_t* from = picture.data() + static_cast<std::size_t>(y) * from_stride +
                               image::row_bytes(state_.shown.format, x);
    for (int row = 0; row < height; ++row, from += from_stride, out += to_stride)
        std::memcpy(out, from, to_stride);
    return true;
}

// Waits. Returns false if the camera is switched off meanwhile.
bool ServedCamera::hold_back(std::chrono::nanoseconds time) {
    std::unique_lock lock(mutex_);
    return !wake_.wait_for(lock, time, [this] { return is_leaving_; });
}

}  // namespace atrium::simulated_cameras
