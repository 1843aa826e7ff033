#include "core/keys/openssl_internal.hpp"
#include "core/keys/tunnel.hpp"

#include <fmt/format.h>
#include <openssl/rand.h>

#include <array>

namespace atrium::keys {
namespace {

constexpr std::size_t kKeyBytes = 32;
using KeyBytes = std::array<unsigned char, kKeyBytes>;

std::string base64(const KeyBytes& bytes) {
    std::array<unsigned char, 4 * ((kKeyBytes + 2) / 3) + 1> text{};
    const int length = EVP_EncodeBlock(text.data(), bytes.data(), static_cast<int>(bytes.size()));
    return {text.begin(), text.begin() + length};
}

}  // namespace

Expected<TunnelKeys> make_tunnel_keys() {
    const NoErrorsLeft none_left;
    const PrivateKey key(EVP_PKEY_Q_keygen(nullptr, nullptr, "X25519"));
    KeyBytes secret{};
    KeyBytes open{};
    std::size_t secret_size = secret.size();
    std::size_t open_size = open.size();
    if (key == nullptr ||
        EVP_PKEY_get_raw_private_key(key.get(), secret.data(), &secret_size) != 1 ||
        EVP_PKEY_get_raw_public_key(key.get(), open.data(), &open_size) != 1)
        return openssl_failed("making a key of the tunnel");
    return TunnelKeys{base64(secret), base64(open)};
}

bool is_tunnel_key(std::string_view text) {
    const NoErrorsLeft none_left;
    // 32 bytes have 43 characters and one '='; the last character has four bits
    if (text.size() != 44 || text.back() != '=') return false;
    std::array<unsigned char, 33> bytes{};
    if (EVP_DecodeBlock(bytes.data(), reinterpret_cast<const unsigned char*>(text.data()), 44) !=
        33)
        return false;
    KeyBytes key{};
    std::copy_n(bytes.begin(), key.size(), key.begin());
    return base64(key) == text;
}

Expected<std::string> draw_subnet() {
    std::array<unsigned char, 2> numbers{};
    if (RAND_bytes(numbers.data(), static_cast<int>(numbers.size())) != 1)
        return openssl_failed("drawing a random number");
    // the upper half: others take 10.0 and 10.1 first
    return fmt::format("10.{}.{}", 128 + numbers[0] % 120, numbers[1]);
}

}  // namespace atrium::keys
