// SPDX-License-Identifier: Apache-2.0
// Files that are whole or absent. See atomic_file.hpp.
#include "sateen/io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

namespace sateen {
namespace {

std::string reason(int code) {
    return std::generic_category().message(code);
}

/// Closes a descriptor that is only read from.
class Descriptor {
  public:
    explicit Descriptor(int value) : value_(value) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (value_ >= 0) ::close(value_);
    }
    [[nodiscard]] int get() const { return value_; }

  private:
    int value_;
};

/// Opens a new file `.NAME.tmp-PID` in the folder of `path`.
int open_beside(const std::string& path, std::string& temporary) {
    const std::size_t name = path.find_last_of('/') + 1;
    std::string stem = path.substr(0, name);
    stem.append(".").append(path, name).append(".tmp-").append(std::to_string(getpid()));
    for (int attempt = 0; attempt < 100; ++attempt) {
        temporary = stem;
        if (attempt > 0) temporary.append("-").append(std::to_string(attempt));
        const int descriptor =
            ::open(temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0 || errno != EEXIST) return descriptor;
    }
    return -1;
}

}  // namespace

Error AtomicFile::failure(int code) const {
    return {Errc::io, path_ + ": cannot be written: " + reason(code)};
}

Result<AtomicFile> AtomicFile::create(std::string path) {
    AtomicFile file;
    file.path_ = std::move(path);
    struct stat status = {};
    const bool exists = ::stat(file.path_.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode))
        return Error{Errc::io, file.path_ + ": is a folder, expected a file to write"};
    if (exists && !S_ISREG(status.st_mode)) {
        file.temporary_ = file.path_;
        file.descriptor_ = ::open(file.path_.c_str(), O_WRONLY | O_CLOEXEC);
    } else {
        file.descriptor_ = open_beside(file.path_, file.temporary_);
    }
    if (file.descriptor_ < 0) return file.failure(errno);
    return file;
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::move(other.temporary_)),
      position_(other.position_),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
    if (this != &other) {
        discard();
        path_ = std::move(other.path_);
        temporary_ = std::move(other.temporary_);
        position_ = other.position_;
        descriptor_ = std::exchange(other.descriptor_, -1);
    }
    return *this;
}

AtomicFile::~AtomicFile() {
    discard();
}

void AtomicFile::discard() noexcept {
    if (descriptor_ < 0) return;
    ::close(std::exchange(descriptor_, -1));
    if (temporary_ != path_) ::unlink(temporary_.c_str());
}

Result<void> AtomicFile::write(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0) {
            if (errno == EINTR) continue;
            return failure(errno);
        }
        const auto count = static_cast<std::size_t>(written);
        position_ += count;
        bytes = bytes.subspan(count);
    }
    return {};
}

Result<std::size_t> AtomicFile::read(std::span<std::uint8_t> bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t got = ::read(descriptor_, bytes.data() + done, bytes.size() - done);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return failure(errno);
        if (got == 0) break;
        done += static_cast<std::size_t>(got);
    }
    position_ += done;
    return done;
}

Result<void> AtomicFile::seek(std::uint64_t offset) {
    if (offset == position_) return {};
    if (::lseek(descriptor_, static_cast<off_t>(offset), SEEK_SET) < 0)
        return failure(errno);
    position_ = offset;
    return {};
}

Result<void> AtomicFile::commit() {
    const int closed = ::close(std::exchange(descriptor_, -1));
    const int close_code = errno;
    if (temporary_ == path_) {
        if (closed != 0) return failure(close_code);
        return {};
    }
    if (closed != 0 || ::rename(temporary_.c_str(), path_.c_str()) != 0) {
        const int code = closed != 0 ? close_code : errno;
        ::unlink(temporary_.c_str());
        return failure(code);
    }
    return {};
}

Result<void> write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
    SATEEN_TRY(AtomicFile file, AtomicFile::create(path));
    SATEEN_CHECK(file.write(bytes));
    return file.commit();
}

Result<std::vector<std::uint8_t>> read_file(const std::string& path,
                                            std::size_t limit_bytes) {
    const auto fail = [&](const std::string& what) {
        return Error{Errc::io, path + ": " + what};
    };
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.get() < 0)
        return fail(errno == ENOENT ? "does not exist"
                                    : "cannot be read: " + reason(errno));
    struct stat status = {};
    if (::fstat(file.get(), &status) != 0) return fail(reason(errno));
    if (S_ISDIR(status.st_mode)) return fail("is a folder, expected a file");

    // A pipe states no size: it is read in growing pieces, like a file that grows.
    std::vector<std::uint8_t> bytes;
    const std::size_t stated =
        S_ISREG(status.st_mode) ? static_cast<std::size_t>(status.st_size) : 0;
    std::size_t done = 0;
    for (;;) {
        if (done > limit_bytes || stated > limit_bytes)
            return Error{Errc::limit_exceeded,
                         path + ": has " +
                             (stated > 0 ? std::to_string(stated) : "too many") +
                             " bytes, expected at most " + std::to_string(limit_bytes)};
        if (done == bytes.size())
            bytes.resize(done == 0 ? stated + 1
                                   : done + std::max<std::size_t>(done, 4096));
        const ssize_t got = ::read(file.get(), bytes.data() + done, bytes.size() - done);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return fail("cannot be read: " + reason(errno));
        if (got == 0) break;
        done += static_cast<std::size_t>(got);
    }
    bytes.resize(done);
    return bytes;
}

}  // namespace sateen
