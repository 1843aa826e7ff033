#pragma once

#include "core/bus/topics.hpp"

#include <array>
#include <cstring>
#include <random>
#include <vector>

namespace atrium {

/// Fills wire structs, sometimes with plausible values, sometimes with random bytes. Owns the
/// memory of their sequences until `forget`.
class Garbage {
public:
    explicit Garbage(std::uint32_t seed) : random_(seed) {}

    void forget() { memory_.clear(); }

    template <typename Wire>
    Wire any() {
        Wire wire;
        std::memset(static_cast<void*>(&wire), 0, sizeof wire);
        fill(wire);
        return wire;
    }

private:
    std::uint32_t below(std::uint32_t limit) { return random_() % limit; }
    bool chance(std::uint32_t percent) { return below(100) < percent; }

    void number(double& v) {
        if (chance(90)) {
            v = std::uniform_real_distribution<double>(-2, 2)(random_);
        } else {
            const std::uint64_t bits = (std::uint64_t{random_()} << 32) | random_();
            std::memcpy(&v, &bits, sizeof v);
        }
    }
    template <std::size_t n>
    void numbers(double (&values)[n]) {
        for (double& v : values) number(v);
    }
    void pose(atrium_Pose& p) {
        numbers(p.rotation);
        numbers(p.translation);
        if (chance(60)) std::copy_n(std::array{0.0, 0.0, 0.0, 1.0}.data(), 4, p.rotation);
    }
    template <std::size_t n>
    void name(char (&text)[n]) {
        const bool plausible = chance(80);
        const std::size_t length = plausible ? 1 + below(3) : below(n);
        for (std::size_t i = 0; i < length; ++i) {
            text[i] =
                plausible ? static_cast<char>('a' + below(3)) : static_cast<char>(1 + below(255));
        }
        text[length] = 0;
    }
    template <typename Sequence>
    auto* elements(Sequence& sequence, std::uint32_t length) {
        using Element = std::remove_pointer_t<decltype(sequence._buffer)>;
        memory_.emplace_back(length * sizeof(Element) + sizeof(Element), 0);
        sequence._buffer = reinterpret_cast<Element*>(memory_.back().data());
        sequence._length = sequence._maximum = length;
        return sequence._buffer;
    }
    template <typename Sequence>
    void numbers16(Sequence& sequence, std::uint32_t length, std::uint32_t end) {
        auto* data = elements(sequence, length);
        for (std::uint32_t i = 0; i < length; ++i) data[i] = static_cast<std::uint16_t>(below(end));
    }
    template <typename Sequence>
    void bytes(Sequence& sequence) {
        auto* data = elements(sequence, below(chance(10) ? 60000 : 300));
        for (std::uint32_t i = 0; i < sequence._length; ++i)
            data[i] = static_cast<std::uint8_t>(random_());
        // begins as a decoder expects
        if (chance(50) && sequence._length > 8)
            std::memcpy(data, chance(50) ? "DRACO\2\2\1" : "\xff\xd8\xff\xe0\0\x10JF", 8);
    }

    void fill(atrium_SiteDescription& w) {
        name(w.site);
        auto* cameras = elements(w.cameras, below(5));
        for (std::uint32_t i = 0; i < w.cameras._length; ++i) {
            name(cameras[i].name);
            cameras[i].width = chance(80) ? 640 : random_();
            cameras[i].height = chance(80) ? 480 : random_();
            for (double* v : {&cameras[i].fx,
                              &cameras[i].fy,
                              &cameras[i].cx,
                              &cameras[i].cy,
                              &cameras[i].skew}) {
                number(*v);
                if (chance(70)) *v = 500;
            }
            numbers(cameras[i].distortion);
            pose(cameras[i].camera_from_site);
        }
        numbers(w.bounds_min);
        numbers(w.bounds_max);
    }
    void fill(atrium_SiteMesh& w) {
        name(w.site);
        w.frame_id = random_();
        w.capture_time_ns =
            chance(50) ? Timestamp::now().ns : static_cast<std::int64_t>(random_()) << 32;
        auto* cameras = elements(w.textured_cameras, below(6));
        for (std::uint32_t i = 0; i < w.textured_cameras._length; ++i)
            cameras[i] = chance(80) ? i : random_();
        auto* frames = elements(w.texture_frames, chance(50) ? 0 : below(6));
        for (std::uint32_t i = 0; i < w.texture_frames._length; ++i)
            frames[i] = {random_(), chance(80) ? Timestamp::now().ns : -1};
        bytes(w.draco);
    }
    void fill(atrium_CameraTexture& w) {
        name(w.site);
        w.camera = chance(80) ? below(4) : random_();
        w.frame_id = random_();
        w.capture_time_ns = Timestamp::now().ns;
        w.crop_x = chance(80) ? below(300) : random_();
        w.crop_y = below(300);
        w.crop_width = chance(80) ? 64 : random_();
        w.crop_height = 64;
        bytes(w.colour);
        bytes(w.mask);
    }
    void fill(atrium_SitePlacement& w) {
        name(w.site);
        pose(w.world_from_site);
    }
    void fill(atrium_SceneObject& w) {
        w.object = below(50);
        name(w.name);
        w.shape = static_cast<std::uint8_t>(chance(80) ? below(8) : random_());
        if (w.shape >= 5 || chance(10)) name(w.model);
        if (chance(10)) name(w.texture);
        w.model_fingerprint = {random_(), random_()};
        w.texture_fingerprint = {random_(), random_()};
        w.model_scale = 1.0;
        if (chance(10)) number(w.model_scale);
        if (chance(10)) number(w.friction);
        if (chance(10)) number(w.restitution);
        numbers(w.size_m);
        number(w.mass_kg);
        numbers(w.colour);
        pose(w.world_from_object);
    }
    void fill(atrium_SoftBody& w) {
        w.object = below(50);
        w.num_nodes = chance(80) ? 4 : random_();
        number(w.thickness_m);
        numbers16(w.triangles, chance(80) ? 3 * below(20) : below(60), 5);
        numbers16(w.segments, chance(80) ? 2 * below(20) : below(60), 5);
    }
    void fill(atrium_SoftBodyState& w) {
        w.object = below(50);
        w.tick = random_();
        w.time_ns = chance(80) ? Timestamp::now().ns : -1;
        numbers(w.origin_m);
        number(w.step_m);
        numbers16(w.nodes, chance(80) ? 12 : below(60), 65536);
    }
    void fill(atrium_PersonProxy& w) {
        name(w.site);
        w.capture_time_ns = chance(80) ? Timestamp::now().ns : -1;
        w.num_surfels = random_();
        numbers(w.origin_m);
        w.step_m = 1e-4;
        if (chance(30)) number(w.step_m);
        auto* points = elements(w.points, below(chance(5) ? 3000 : 60));
        for (std::uint32_t i = 0; i < w.points._length; ++i) raw(points[i]);
        auto* touches = elements(w.touches, below(20));
        for (std::uint32_t i = 0; i < w.touches._length; ++i) {
            touches[i].object = below(50);
            numbers(touches[i].point_world);
        }
    }
    void fill(atrium_ObjectProxy& w) {
        w.object = below(50);
        numbers(w.origin_m);
        w.step_m = 1e-4;
        if (chance(30)) number(w.step_m);
        numbers16(w.vertices, chance(80) ? 12 : below(60), 65536);
        numbers16(w.edges, chance(80) ? 2 * below(20) : below(60), 5);
    }
    void fill(atrium_Scenery& w) {
        name(w.name);
        name(w.model);
        w.model_scale = 1.0;
        if (chance(30)) name(w.texture);
        w.model_fingerprint = {random_(), random_()};
        w.texture_fingerprint = {random_(), random_()};
        numbers(w.colour);
        pose(w.world_from_model);
    }
    void fill(atrium_SceneState& w) {
        name(w.world);
        w.tick = random_();
        w.time_ns = chance(50) ? Timestamp::now().ns : -1;
        auto* objects = elements(w.objects, below(20));
        for (std::uint32_t i = 0; i < w.objects._length; ++i) {
            objects[i].object = below(50);
            pose(objects[i].world_from_object);
            numbers(objects[i].linear_velocity);
            numbers(objects[i].angular_velocity);
        }
    }
    void fill(atrium_SceneCommand& w) {
        name(w.sender);
        w.kind = static_cast<std::uint8_t>(chance(80) ? below(9) : random_());
        w.target = below(50);
        numbers(w.impulse_ns);
        numbers(w.point_object);
        numbers(w.goal_world);
        fill(w.object);
    }
    void fill(atrium_SceneEdit& w) {
        name(w.sender);
        w.kind = static_cast<std::uint8_t>(chance(80) ? below(8) : random_());
        w.number = below(50);
        w.target = below(50);
        w.revision = chance(50) ? 0xffffffffU : below(3);
        name(w.world_file);
        pose(w.world_from_object);
        fill(w.object);
    }
    void fill(atrium_EditResult& w) {
        raw(w);
        name(w.sender);
    }
    void fill(atrium_SavedWorlds& w) {
        raw(w);
        name(w.world);
        auto* worlds = elements(w.worlds, below(6));
        for (std::uint32_t i = 0; i < w.worlds._length; ++i) name(worlds[i].name);
    }
    void fill(atrium_SiteStatus& w) {
        raw(w);
        name(w.site);
        w.cameras = {};
        auto* cameras = elements(w.cameras, below(6));
        for (std::uint32_t i = 0; i < w.cameras._length; ++i) {
            raw(cameras[i]);
            name(cameras[i].name);
            if (chance(70)) cameras[i].connected = static_cast<std::uint8_t>(below(2));
            number(cameras[i].offset_ms);
            number(cameras[i].last_picture_age_ms);
        }
        fill(w.coherence);
        name(w.finding);
        w.hosts = {};
        auto* hosts = elements(w.hosts, below(4));
        for (std::uint32_t i = 0; i < w.hosts._length; ++i) {
            raw(hosts[i]);
            name(hosts[i].name);
            number(hosts[i].clock_offset_ms);
            number(hosts[i].clock_error_ms);
        }
    }
    void fill(atrium_RigCoherence& w) {
        name(w.fault.cure);
        if (chance(70)) w.verdict = static_cast<std::uint8_t>(below(6));
        w.cameras = {};
        auto* cameras = elements(w.cameras, below(6));
        for (std::uint32_t i = 0; i < w.cameras._length; ++i) {
            raw(cameras[i]);
            name(cameras[i].name);
            number(cameras[i].rms_px);
            if (chance(70)) cameras[i].share = 0.9;
        }
    }
    void fill(atrium_WorldStatus& w) {
        raw(w);
        name(w.world);
    }
    void fill(atrium_ViewerStatus& w) {
        raw(w);
        name(w.viewer);
    }
    void fill(atrium_Presence& w) {
        raw(w);
        w.is_holder = chance(50);
        w.is_clock_synchronised = chance(50);
        w.kind = static_cast<std::uint8_t>(chance(80) ? below(4) : random_());
        name(w.member);
        name(w.host);
        name(w.version);
    }
    template <typename Wire>
    void raw(Wire& w) {
        auto* bytes_of = reinterpret_cast<std::uint8_t*>(&w);
        for (std::size_t i = 0; i < sizeof w; ++i)
            bytes_of[i] = static_cast<std::uint8_t>(random_());
    }

    std::mt19937 random_;
    std::vector<std::vector<std::uint8_t>> memory_;
};

}  // namespace atrium
