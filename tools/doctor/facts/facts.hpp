#pragma once

#include "core/base/timestamp.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// What is known of a host. An empty optional is unknown: no check judges it.
namespace atrium::doctor {

/// IPv4 address in host byte order.
struct CardAddress {
    std::string card;
    std::uint32_t address = 0;
    int prefix = 32;  // bits of the network
};

/// Of a card, for packets that come in [packets].
struct ReceiveRing {
    std::uint64_t now = 0;
    std::uint64_t largest = 0;
};

struct Card {
    std::string name;
    std::string mac;  // empty: unknown
    bool is_up = false;
    bool is_loopback = false;
    bool has_multicast = false;
    bool is_wired = false;  // a device without radio: no bridge, tunnel or virtual card
    int mtu = 0;            // [bytes]; 0: unknown
    int speed_mbit = 0;     // 0: unknown
    bool is_half_duplex = false;
    std::uint64_t received = 0;  // packets since the start of the host
    std::uint64_t lost = 0;      // packets for which the card had no room
    std::uint64_t damaged = 0;   // packets with wrong checksums
    std::optional<ReceiveRing> ring;
    int rp_filter = 0;  // 0 off, 1 strict, 2 loose
    std::vector<CardAddress> addresses;
};

struct Route {
    std::string card;
    std::uint32_t destination = 0;
    std::uint32_t mask = 0;
};

enum class Firewall : std::uint8_t { kNone, kUfw, kFirewalld, kNft, kIptables };

struct NetworkFacts {
    std::optional<std::uint64_t> rmem_max;  // [bytes]
    std::optional<std::uint64_t> wmem_max;  // [bytes]
    std::optional<std::uint64_t> ipfrag_time_s;
    std::optional<std::uint64_t> ipfrag_memory;  // [bytes]
    std::vector<Card> cards;
    std::vector<Route> routes;
    std::string nft_rules;       // JSON of nft; empty: not readable
    std::string iptables_rules;  // text of iptables-save; empty: not readable
    bool has_ufw = false;
    bool has_ethtool = true;
    std::string card;                     // that Atrium uses; empty: none
    bool is_card_by_chance = false;       // no option and no default route chose it
    std::optional<bool> hears_multicast;  // on `card`, from this host
};

struct FoundCamera {
    std::string name;  // vendor and model
    std::string serial;
    std::string address;  // IPv4, or device id
    bool is_gige = false;
};

struct UsbCamera {
    std::string node;    // /dev/bus/usb/002/003
    int speed_mbit = 0;  // 480: USB 2
    bool is_permitted = true;
};

struct CameraFacts {
    std::optional<std::vector<FoundCamera>> found;  // that answer
    std::vector<UsbCamera> usb;
    std::optional<std::uint64_t> usb_memory_mb;
};

struct Program {
    std::string name;
    std::filesystem::path path;
    bool is_there = false;
    std::string version;  // empty: it does not run
    std::vector<std::string> missing_libraries;
    std::optional<bool> has_net_raw;  // file capability
};

struct User {
    std::string name;
    bool is_root = false;
    std::vector<unsigned> groups;
    unsigned id = 0;
    bool has_net_raw = false;  // capability of this process
    bool has_sys_nice = false;
};

/// What chronyd knows of its clock.
struct ChronyFacts {
    std::string source;       // address of the time server; empty: none
    double bound_ms = 0.0;    // of the error to the true time
    double follows_ms = 0.0;  // difference to the time server, three sigma
};

struct ClockFacts {
    std::optional<bool> is_synchronised;
    // of the kernel: what the daemon said last, and 0.5 ms for each second since then
    double max_error_ms = 0.0;
    std::optional<ChronyFacts> chrony;
    bool serves_others = false;        // chronyd gives its time to other hosts
    std::vector<std::string> daemons;  // that set this clock, as their processes are named
};

struct GraphicsFacts {
    bool has_display_card = false;          // on the PCI bus
    std::string vendor_without_driver;      // PCI vendor id of a display card that has none
    std::vector<std::string> nodes;         // /dev/dri/renderD*
    std::vector<std::string> closed_nodes;  // of them, those that this user may not open
    std::optional<bool> is_hardware;        // EGL draws on a GPU
    std::string reason;                     // why not
};

struct LoadFacts {
    int cores = 0;                     // online
    std::optional<double> busy_cores;  // by others than Atrium, over about one second
    std::vector<std::string>
        atrium_programs;  // that run, "site_node 1234", "camera_node --host north 1235"
    std::string governor;
    std::string governor_preference;             // energy_performance_preference; empty: none
    double max_ghz = 0.0;                        // of the processor; 0: unknown
    double capped_ghz = 0.0;                     // that the system allows
    std::optional<std::uint64_t> num_throttled;  // events in about one second
    std::optional<double> quota_cores;           // of the control group
    std::string quota_group;
    std::optional<std::uint64_t> memory_total;      // [bytes]
    std::optional<std::uint64_t> memory_available;  // [bytes]
    std::uint64_t swap_used = 0;                    // [bytes]
};

struct FolderFacts {
    std::filesystem::path folder;
    std::string problem;  // why it cannot be written; empty: it can
    std::uint64_t free_bytes = 0;
    double write_mb_per_s = 0.0;  // 0: not measured
};

struct Certificate {
    std::filesystem::path file;
    std::optional<Timestamp> begins;
    std::optional<Timestamp> ends;
    // of a bundle of `atrium keys`: its member, "site alice of world playroom", its name, and why
    // it is not usable although its time is right (empty: it is)
    std::string member{};
    std::string member_name{};
    std::string problem{};
    bool is_open = false;  // others can read the bundle
    // the key store beside the bundle that has revoked it; empty: none has
    std::filesystem::path revoked_by{};
};

struct KeyFacts {
    std::filesystem::path folder;
    bool is_there = false;
    std::string meant{};      // if it is not there: "did you mean bob.bundle?", or empty
    bool is_readable = true;  // by this user
    bool has_openssl = true;
    std::vector<Certificate> certificates;
    // private keys that others may use, or that their group may write
    std::vector<std::filesystem::path> open_keys;
};

struct SiteCamera {
    std::string name;
    std::string serial;
    std::string address;
    double megapixels = 0.0;
    double bytes_per_pixel = 1.0;
};

/// The `[[host]]` of a site file, as this host sees them.
struct SiteHosts {
    std::vector<std::string> names;  // of all; empty: the site is one process
    std::string own;                 // name of this host; empty: unknown
    bool is_listed = false;          // `own` is one of them
    bool has_cameras = false;        // this host runs camera_node
    bool is_model = false;           // this host collects the silhouettes
    bool has_regions = false;        // this host computes the hulls of some regions
    bool runs_site_node() const { return is_model || has_regions; }
};

/// What the file of a site, world or viewer asks of this host.
struct Wishes {
    std::filesystem::path file;  // empty: no file
    std::string network = "lan";
    std::string interface;  // empty: none named
    bool has_peers = false;
    std::uint32_t domain = 0;
    std::filesystem::path keys;  // bundle or invitation; empty: none named
    std::string source;          // of pictures: simulated, recording, cameras; empty: none
    std::string rig_problem;     // empty: the rig can be read
    std::filesystem::path rig;
    std::filesystem::path recording;
    bool is_recording_there = true;
    // Kept silhouettes, where the file names a folder. Else the folder of the site's start counts.
    std::filesystem::path cache;
    double rate_hz = 0.0;
    int nice = 0;                     // process.nice
    std::vector<SiteCamera> cameras;  // of a site on several hosts: those of this host
    SiteHosts hosts;
    /// The programs that read the file on this host.
    struct Reader {
        std::string program;
        std::string host;  // its --host; empty: without
    };
    std::vector<Reader> readers;
};

/// What Atrium's Debian packages, or an installation by hand, set up on this host.
struct PackageFacts {
    bool has_programs = false;  // the examined programs are those of packages
    bool has_usb_rule = false;
    bool runs_file = false;         // a service reads the file, as its own user with its own rights
    std::optional<unsigned> group;  // of the services' user
};

struct Roles {
    bool site = false;
    bool world = false;
    bool viewer = false;
    bool camera = false;
};

struct Facts {
    Roles roles;
    User user;
    Wishes wishes;
    PackageFacts packages;
    std::vector<Program> programs;
    NetworkFacts network;
    CameraFacts cameras;
    ClockFacts clock;
    GraphicsFacts graphics;
    LoadFacts load;
    std::optional<std::uint64_t> realtime_limit;  // RLIMIT_RTPRIO
    std::optional<std::uint64_t> nice_limit;      // RLIMIT_NICE: 20 less the lowest niceness
    std::optional<FolderFacts> recordings;
    std::optional<FolderFacts> cache;
    std::optional<KeyFacts> keys;
    Timestamp now;
};

}  // namespace atrium::doctor
