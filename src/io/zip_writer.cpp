// SPDX-License-Identifier: Apache-2.0
// Zip by libzip, which writes beside the name and renames. See zip_writer.hpp.
#include "sateen/io/zip_writer.hpp"

#include <zip.h>

#include <memory>

namespace sateen {
namespace {

struct DiscardArchive {
    void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, DiscardArchive>;

Error failure(const std::string& path, const std::string& what) {
    return {Errc::io, path + ": cannot be written: " + what};
}

Error failure(const std::string& path, zip_t* archive) {
    return failure(path, zip_error_strerror(zip_get_error(archive)));
}

Result<void> add(zip_t* archive, const std::string& path, const ZipMember& member) {
    zip_source_t* const source = zip_source_file(archive, member.path.c_str(), 0, -1);
    if (source == nullptr) return failure(path, archive);
    const zip_int64_t index =
        zip_file_add(archive, member.name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
        zip_source_free(source);
        return failure(path + ", " + member.name, archive);
    }
    const auto entry = static_cast<zip_uint64_t>(index);
    // Midnight of 1980-01-01: year 0, month 1, day 1.
    constexpr zip_uint16_t kFirstDay = (1 << 5) | 1;
    if (zip_set_file_compression(archive, entry, ZIP_CM_STORE, 0) != 0 ||
        zip_file_set_dostime(archive, entry, 0, kFirstDay, 0) != 0)
        return failure(path + ", " + member.name, archive);
    return {};
}

void report(zip_t*, double share, void* progress) {
    static_cast<Progress*>(progress)->report(share, 1);
}
int cancelled(zip_t*, void* progress) {
    return static_cast<const Progress*>(progress)->cancelled() ? 1 : 0;
}

}  // namespace

Result<void> write_zip(const std::string& path, const std::vector<ZipMember>& members,
                       Progress& progress) {
    int code = 0;
    Archive archive(zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code));
    if (!archive) {
        zip_error_t error;
        zip_error_init_with_code(&error, code);
        const Error result = failure(path, zip_error_strerror(&error));
        zip_error_fini(&error);
        return result;
    }
    for (const ZipMember& member : members)
        SATEEN_CHECK(add(archive.get(), path, member));
    constexpr double kStep = 0.01;
    zip_register_progress_callback_with_state(archive.get(), kStep, report, nullptr,
                                              &progress);
    zip_register_cancel_callback_with_state(archive.get(), cancelled, nullptr, &progress);
    if (zip_close(archive.get()) != 0) {
        if (zip_error_code_zip(zip_get_error(archive.get())) == ZIP_ER_CANCELLED)
            return Error{Errc::cancelled, "cancelled"};
        return failure(path, archive.get());
    }
    // Closed, hence gone.
    (void)archive.release();
    return {};
}

}  // namespace sateen
