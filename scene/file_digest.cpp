#include "scene/file_digest.h"

#include <array>
#include <fmt/format.h>
#include <fstream>
#include <new>
#include <openssl/evp.h>
#include <vector>

#include "core/error.h"
#include "core/files/text_file.h"

namespace postlens {

struct Sha256::Impl {
    Impl() = default;
    ~Impl() { EVP_MD_CTX_free(context); }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    Impl(Impl&&) = delete;
    Impl& operator=(Impl&&) = delete;

    EVP_MD_CTX* context = nullptr;
};

Sha256::Sha256() : impl_(std::make_unique<Impl>()) {
    impl_->context = EVP_MD_CTX_new();
    if (impl_->context == nullptr || EVP_DigestInit_ex(impl_->context, EVP_sha256(), nullptr) != 1) {
        throw std::bad_alloc();
    }
}

Sha256::~Sha256() = default;

void Sha256::add(std::string_view bytes) {
    if (EVP_DigestUpdate(impl_->context, bytes.data(), bytes.size()) != 1) throw std::bad_alloc();
}

std::string Sha256::hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int length = 0;
    if (EVP_DigestFinal_ex(impl_->context, digest.data(), &length) != 1) throw std::bad_alloc();
    std::string text;
    for (unsigned int i = 0; i < length; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
}

std::string sha256_of_file(const std::filesystem::path& path) {
    check_regular_file(path);
    std::ifstream file(path, std::ios::binary);
    if (!file) fail(ExitCode::invalid_input, "{}: cannot read", path.string());
    Sha256 digest;
    std::vector<char> chunk(std::size_t{1} << 20);
    while (file.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || file.gcount() > 0) {
        digest.add({chunk.data(), static_cast<std::size_t>(file.gcount())});
    }
    if (file.bad()) fail(ExitCode::invalid_input, "{}: cannot read", path.string());
    return digest.hex();
}

}  // namespace postlens
