#include "tests/support/fake_gige_camera.hpp"

#include <arv.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

namespace atrium::test_support {
namespace {

namespace fs = std::filesystem;

// Features of real cameras that the description of Aravis' fake camera lacks.
constexpr const char* kMoreFormats = R"(
<EnumEntry Name="BGR8" NameSpace="Standard"><Value>35127317</Value></EnumEntry>
<EnumEntry Name="YUV422_8" NameSpace="Standard"><Value>34603058</Value></EnumEntry>
<EnumEntry Name="YUV422_8_UYVY" NameSpace="Standard"><Value>34603039</Value></EnumEntry>
<EnumEntry Name="Mono8" )";
constexpr const char* kMoreFeatures = R"(
<Boolean Name="GevIEEE1588"><pValue>PtpRegister</pValue><OnValue>1</OnValue><OffValue>0</OffValue></Boolean>
<Enumeration Name="GevIEEE1588Status">
  <EnumEntry Name="Disabled"><Value>0</Value></EnumEntry><EnumEntry Name="Slave"><Value>1</Value></EnumEntry>
  <pValue>PtpRegister</pValue>
</Enumeration>
<IntReg Name="PtpRegister"><Address>0x400</Address><Length>4</Length><AccessMode>RW</AccessMode>
  <pPort>Device</pPort><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></IntReg>
<Enumeration Name="BalanceWhiteAuto">
  <EnumEntry Name="Off"><Value>0</Value></EnumEntry><EnumEntry Name="Once"><Value>1</Value></EnumEntry>
  <pValue>BalanceRegister</pValue>
</Enumeration>
<IntReg Name="BalanceRegister"><Address>0x410</Address><Length>4</Length><AccessMode>RW</AccessMode>
  <pPort>Device</pPort><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></IntReg>
</RegisterDescription>)";

void replace_once(std::string& text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    if (at != std::string::npos) text.replace(at, from.size(), to);
}

// Aravis exposes its description only through a camera that uses it.
std::string plain_description(const std::string& address) {
    auto* const camera = arv_gv_fake_camera_new(address.c_str(), "description");
    GInetAddress* const inet = g_inet_address_new_from_string(address.c_str());
    ArvDevice* const device = arv_gv_device_new(inet, inet, nullptr);
    std::string text;
    if (device != nullptr) {
        std::size_t size = 0;
        const char* const xml = arv_device_get_genicam_xml(device, &size);
        text.assign(xml, size);
        g_object_unref(device);
    }
    g_object_unref(inet);
    g_object_unref(camera);
    return text;
}

const std::string& description_file(const std::string& address) {
    static const std::string file = [&] {
        std::string text = plain_description(address);
        replace_once(text, "<EnumEntry Name=\"Mono8\" ", kMoreFormats);
        replace_once(text, "</RegisterDescription>", kMoreFeatures);
        const fs::path path =
            fs::temp_directory_path() / ("atrium_fake_camera_" + std::to_string(getpid()) + ".xml");
        std::ofstream(path) << text;
        return path.string();
    }();
    return file;
}

}  // namespace

struct FakeGigeCamera::Impl {
    Options options;
    ArvGvFakeCamera* camera = nullptr;
    std::atomic<std::uint64_t> num_sent{0};

    static void fill(ArvBuffer* buffer, void* self, guint32, guint32, ArvPixelFormat format) {
        auto& impl = *static_cast<Impl*>(self);
        const std::uint64_t number = impl.options.first_number + impl.num_sent++;
        auto* const data =
            static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, nullptr)));
        const std::size_t num_bytes =
            static_cast<std::size_t>(arv_buffer_get_image_width(buffer)) *
            static_cast<std::size_t>(arv_buffer_get_image_height(buffer)) *
            ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format) / 8;
        std::memcpy(data, &number, sizeof(number));
        for (std::size_t i = sizeof(number); i < num_bytes; ++i) data[i] = expected_byte(number, i);
        if (impl.options.clock) {
            const auto host_ns = static_cast<std::uint64_t>(g_get_real_time()) * 1000;
            arv_buffer_set_timestamp(buffer, impl.options.clock(number, host_ns));
        }
    }
};

FakeGigeCamera::FakeGigeCamera(const Options& options) : impl_(std::make_unique<Impl>()) {
    impl_->options = options;
    impl_->camera = arv_gv_fake_camera_new_full(
        options.address.c_str(), options.serial.c_str(), description_file(options.address).c_str());
    g_object_set(impl_->camera, "gvsp-lost-ratio", options.lost_packets, nullptr);
    ArvFakeCamera* const sensor = arv_gv_fake_camera_get_fake_camera(impl_->camera);
    arv_fake_camera_set_fill_pattern(sensor, &Impl::fill, impl_.get());
    arv_fake_camera_set_trigger_frequency(sensor, options.trigger_check_hz);
}

FakeGigeCamera::~FakeGigeCamera() { g_object_unref(impl_->camera); }

bool FakeGigeCamera::is_running() const { return arv_gv_fake_camera_is_running(impl_->camera); }

std::uint64_t FakeGigeCamera::num_sent() const { return impl_->num_sent; }

std::uint8_t FakeGigeCamera::expected_byte(std::uint64_t number, std::size_t i) {
    return static_cast<std::uint8_t>(number * 31 + i * 7 + (i >> 9));
}

std::uint64_t FakeGigeCamera::number_in(const std::uint8_t* picture) {
    std::uint64_t number = 0;
    std::memcpy(&number, picture, sizeof(number));
    return number;
}

std::uint32_t FakeGigeCamera::register_value(std::uint32_t address) const {
    guint32 value = 0;
    arv_fake_camera_read_register(
        arv_gv_fake_camera_get_fake_camera(impl_->camera), address, &value);
    return value;
}

}  // namespace atrium::test_support
