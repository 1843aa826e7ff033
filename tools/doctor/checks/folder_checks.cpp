#include "tools/doctor/checks/checks.hpp"
#include "tools/doctor/facts/collect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::doctor {
namespace {

constexpr std::uint64_t kMinFree = std::uint64_t{10} << 30U;
constexpr double kMinWrite_mb_per_s = 50.0;
constexpr double kSoon_days = 30.0;

double days_between(Timestamp from, Timestamp to) {
    return static_cast<double>(to.ns - from.ns) / 1e9 / 86'400.0;
}

// [MB/s] of the pictures of the site file.
double asked_mb_per_s(const Wishes& wishes) {
    double mb_per_s = 0.0;
    for (const SiteCamera& camera : wishes.cameras)
        mb_per_s += camera.megapixels * camera.bytes_per_pixel * wishes.rate_hz;
    return wishes.source == "cameras" ? mb_per_s : 0.0;
}

// Never gives a folder of the system to the user: makes one in it, or opens the disk.
std::string cure_of_folder(const Facts& facts,
                           const std::string& problem,
                           const std::string& existing,
                           const std::string& wanted) {
    if (problem.find("Read-only") != std::string::npos) {
        return fmt::format("sudo mount -o remount,rw \"$(findmnt -n -o TARGET -T {})\"",
                           shell_word(existing));
    }
    return fmt::format("sudo install -d -o {} {}", shell_word(facts.user.name), shell_word(wanted));
}

void check_recordings(const Facts& facts, Findings& findings) {
    if (!facts.recordings) return;
    const FolderFacts& disk = *facts.recordings;
    const std::string folder = disk.folder.string();
    if (!disk.problem.empty()) {
        findings.push_back(make_finding(
            "folder_not_writable",
            fmt::format(
                "The folder for recordings, {}, cannot be written: {}.", folder, disk.problem),
            cure_of_folder(facts, disk.problem, folder, folder + "/atrium")));
        return;
    }
    if (disk.free_bytes < kMinFree) {
        findings.push_back(make_finding(
            "disk_full",
            fmt::format("The disk of {} has {} left; wanted are {}: remove what the command lists "
                        "last.",
                        folder,
                        size_text(disk.free_bytes),
                        size_text(kMinFree)),
            fmt::format("sudo du -xh --max-depth=2 {} | sort -h | tail", shell_word(folder))));
    }
    const double wanted = std::max(kMinWrite_mb_per_s, asked_mb_per_s(facts.wishes));
    if (disk.write_mb_per_s > 0.0 && disk.write_mb_per_s < wanted) {
        findings.push_back(make_finding(
            "disk_slow",
            fmt::format("The disk of {} writes {:.0f} MB/s; a recording wants {:.0f}: choose a "
                        "folder on one of the disks that the command lists.",
                        folder,
                        disk.write_mb_per_s,
                        std::ceil(wanted)),
            "lsblk -o NAME,MODEL,ROTA,TRAN,MOUNTPOINT"));
    }
}

}  // namespace

Findings check_folders(const Facts& facts) {
    Findings findings;
    check_recordings(facts, findings);
    if (facts.cache && !facts.cache->problem.empty()) {
        findings.push_back(make_finding(
            "cache_not_writable",
            fmt::format(
                "The cache folder {} cannot be written ({}): a site cannot keep silhouettes.",
                facts.wishes.cache.string(),
                facts.cache->problem),
            cure_of_folder(facts,
                           facts.cache->problem,
                           facts.cache->folder.string(),
                           facts.wishes.cache.string())));
    }
    return findings;
}

namespace {

// What names the certificate in a finding, how to get a new one, and the command.
struct Renewal {
    std::string what;
    std::string how;
    std::string cure;
};

Renewal renewal_of(const Certificate& certificate) {
    const std::string file = certificate.file.string();
    if (certificate.member.empty())
        return {"certificate " + file,
                "let its authority sign a new one (replace KEY by its private key)",
                fmt::format("openssl x509 -x509toreq -in {0} -signkey KEY -out {0}.csr",
                            shell_word(file))};
    return {fmt::format("key of {} in {}", certificate.member, file),
            "on the computer of the world's owner make a new one, export it and bring it here",
            "atrium keys renew " + certificate.member_name};
}

// Closes no file to others but a bundle: programs need to read what else it may be.
std::string cure_of_bundle(const Certificate& certificate) {
    const std::string file = shell_word(certificate.file.string());
    if (certificate.member.empty()) return "atrium keys export NAME -o NAME.bundle";
    return (certificate.is_open ? "chmod 600 " + file + "; " : "") + "atrium keys check " + file;
}

void check_certificate(const Certificate& certificate, const Facts& facts, Findings& findings) {
    const Renewal renewal = renewal_of(certificate);
    if (certificate.ends && *certificate.ends < facts.now) {
        findings.push_back(
            make_finding("key_expired",
                         fmt::format("The {} expired {:.0f} days ago: {}.",
                                     renewal.what,
                                     std::ceil(days_between(*certificate.ends, facts.now)),
                                     renewal.how),
                         renewal.cure));
    } else if (certificate.ends && days_between(facts.now, *certificate.ends) < kSoon_days) {
        findings.push_back(
            make_finding("key_expires_soon",
                         fmt::format("The {} expires in {:.0f} days: {}.",
                                     renewal.what,
                                     std::floor(days_between(facts.now, *certificate.ends)),
                                     renewal.how),
                         renewal.cure));
    }
    if (certificate.begins && facts.now < *certificate.begins) {
        findings.push_back(make_finding(
            "key_not_yet_valid",
            fmt::format("The {} is valid only in {:.0f} days: the clock of this host or of its "
                        "authority is wrong.",
                        renewal.what,
                        std::ceil(days_between(facts.now, *certificate.begins))),
            "timedatectl && sudo timedatectl set-ntp true"));
    }
    if (!certificate.revoked_by.empty()) {
        findings.push_back(make_finding(
            "bundle_not_usable",
            fmt::format("The {} is revoked, says {}: if the member may take part, make a new one, "
                        "export it and bring it here.",
                        renewal.what,
                        certificate.revoked_by.string()),
            fmt::format(
                "{} --keys {}", renewal.cure, shell_word(certificate.revoked_by.string()))));
    } else if (!certificate.problem.empty()) {
        findings.push_back(make_finding(
            "bundle_not_usable",
            certificate.member.empty()
                ? fmt::format("No bundle of `atrium keys`: {}. On the computer of the "
                              "world's owner export it, and bring it here.",
                              certificate.problem)
                : fmt::format("The {} is not usable: {}.", renewal.what, certificate.problem),
            cure_of_bundle(certificate)));
    }
}

}  // namespace

Findings check_keys(const Facts& facts) {
    Findings findings;
    if (!facts.keys) return findings;
    const KeyFacts& keys = *facts.keys;
    if (!keys.is_there && keys.folder.has_extension()) {
        findings.push_back(make_finding(
            "keys_missing",
            fmt::format("The file of keys {} is not there: on the computer of the world's owner "
                        "export it, and bring it here.",
                        keys.folder.string()),
            fmt::format("atrium keys export NAME -o {}", shell_word(keys.folder.string()))));
    } else if (!keys.is_there && keys.folder.has_filename() && keys.folder != kKeys) {
        findings.push_back(make_finding(
            "keys_missing",
            fmt::format("Neither a bundle nor a folder of keys is at {}{} Give the path of one: "
                        "the command lists those of this host.",
                        keys.folder.string(),
                        keys.meant.empty() ? "." : ": " + keys.meant),
            "sudo find /home /root /etc -name '*.bundle' -o -name '*.invitation'"));
    } else if (!keys.is_there) {
        findings.push_back(
            make_finding("keys_missing",
                         fmt::format("The folder of keys {} is not there.", keys.folder.string()),
                         fmt::format("sudo {} {}",
                                     facts.packages.group ? "install -d -m 0750 -o root -g atrium"
                                                          : "mkdir -m 700 -p",
                                     shell_word(keys.folder.string()))));
    }
    if (!keys.has_openssl) {
        findings.push_back(make_finding("openssl_missing",
                                        "The dates of certificates are unknown without openssl.",
                                        "sudo apt install openssl"));
    }
    for (const Certificate& certificate : keys.certificates)
        check_certificate(certificate, facts, findings);
    for (const auto& key : keys.open_keys) {
        findings.push_back(make_finding(
            "private_key_readable",
            fmt::format("Other users may read or write the private key {}.", key.string()),
            fmt::format("sudo chmod o-rwx,g-w {}", shell_word(key.string()))));
    }
    return findings;
}

Findings check_all(const Facts& facts) {
    Findings all;
    for (const auto check : {&check_programs,
                             &check_site_file,
                             &check_network,
                             &check_firewall,
                             &check_cameras,
                             &check_clock,
                             &check_graphics,
                             &check_load,
                             &check_folders,
                             &check_keys}) {
        Findings found = check(facts);
        std::move(found.begin(), found.end(), std::back_inserter(all));
    }
    // one cause is enough
    const auto is_firewall = [](const Finding& one) { return one.id == "firewall_drops_dds"; };
    if (std::any_of(all.begin(), all.end(), is_firewall))
        std::erase_if(all, [](const Finding& one) { return one.id == "multicast_not_heard"; });
    std::stable_sort(all.begin(), all.end(), [](const Finding& a, const Finding& b) {
        return a.severity < b.severity;
    });
    return all;
}

}  // namespace atrium::doctor
