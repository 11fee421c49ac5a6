/* Stands between a program and the C library: counts, records, and at one of them hinders, the file calls that concern a folder.

   Loaded with LD_PRELOAD; what to do stands in a file that TORSIONBOOK_FILE_CALLS names and that all processes share
   (`struct control`, written by file_calls.py). Without that name every call goes through as it is. Linux only. */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

enum { COUNT, KILL, KILL_HALFWAY, FAIL, FULL };
enum { CREATED = 1, TRUNCATED, WRITTEN, FLUSHED, RENAMED, REMOVED, FOLDER_MADE, FOLDER_FLUSHED, LINKED };
/* What a call does: reads, changes something, or changes something and needs room on the disk. */
enum { READS, CHANGES, GROWS };

struct control {
    int64_t calls, changes, grows, writes; /* So far, in all processes: all; that change something; that need room; writes. */
    int64_t at, way, error;                /* At which of the calls that the way looks for what is done. */
    char folder[1024], log[1024];
};
struct entry { /* One change in the log; two paths and the data follow. */
    int64_t what, inode, offset, first, second, size;
};

static struct control *control;
static int journal = -1;

#define REAL(type, name, ...) \
    static type (*real)(__VA_ARGS__); \
    if (!real) real = (type (*)(__VA_ARGS__))dlsym(RTLD_NEXT, #name)

__attribute__((visibility("default"))) void file_calls_begin(const char *path) {
    REAL(int, open, const char *, int, ...);
    int handle = real(path, O_RDWR | O_CLOEXEC);
    if (handle < 0) return;
    void *at = mmap(NULL, sizeof(struct control), PROT_READ | PROT_WRITE, MAP_SHARED, handle, 0);
    close(handle);
    if (at == MAP_FAILED) return;
    struct control *shared = at;
    if (shared->log[0]) journal = real(shared->log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    control = shared;
}

__attribute__((constructor)) static void begin(void) {
    const char *path = getenv("TORSIONBOOK_FILE_CALLS");
    if (path && *path) file_calls_begin(path);
}

static int below(const char *path) {
    size_t length = strlen(control->folder);
    return !strncmp(path, control->folder, length) && (path[length] == '/' || !path[length]);
}

/* The path of a handle. */
static int held(int handle, char *out) {
    char name[64];
    snprintf(name, sizeof name, "/proc/self/fd/%d", handle);
    ssize_t length = readlink(name, out, PATH_MAX - 1);
    if (length < 0) return 0;
    out[length] = 0;
    return 1;
}

static int concerns_handle(int handle, char *out) {
    if (!control) return 0;
    int before = errno, is = held(handle, out) && below(out);
    errno = before;
    return is;
}

static int concerns(int folder, const char *path, char *out) {
    if (!control || !path) return 0;
    int before = errno, is = 0;
    if (!*path) is = held(folder, out) && below(out);
    else if (*path == '/') {
        snprintf(out, PATH_MAX, "%s", path);
        is = below(out);
    } else {
        char base[PATH_MAX];
        if (folder == AT_FDCWD ? getcwd(base, sizeof base) != NULL : held(folder, base)) {
            if (!strcmp(path, ".")) snprintf(out, PATH_MAX, "%s", base);
            else if (snprintf(out, PATH_MAX, "%s/%s", base, path) >= PATH_MAX) out[0] = 0;
            is = below(out);
        }
    }
    errno = before;
    return is;
}

static void end_all(void) {
    kill(0, SIGKILL);
    for (;;) pause();
}

static int64_t next(int64_t *counter) { return __atomic_add_fetch(counter, 1, __ATOMIC_SEQ_CST); }

/* Called before each call; nonzero where it fails. *half: only half of a write. */
static int hindered(int kind, int *half) {
    int64_t call = next(&control->calls), at = control->at;
    int64_t change = kind == READS ? 0 : next(&control->changes), grow = kind == GROWS ? next(&control->grows) : 0;
    int64_t write = half ? next(&control->writes) : 0;
    if (control->way == KILL && change == at) end_all();
    if (control->way == KILL_HALFWAY && write == at) *half = 1;
    if (control->way == FAIL && call == at) {
        errno = (int)control->error;
        return 1;
    }
    if (control->way == FULL && grow >= at) {
        if (half && grow == at) {
            *half = 1;
            return 0;
        }
        errno = ENOSPC;
        return 1;
    }
    return 0;
}

static void note(int what, int64_t inode, const char *first, const char *second, int64_t offset, const void *data, int64_t size) {
    if (journal < 0) return;
    int before = errno;
    struct entry entry = {what, inode, offset, (int64_t)strlen(first), (int64_t)strlen(second), size};
    struct iovec parts[4] = {{&entry, sizeof entry}, {(void *)first, strlen(first)}, {(void *)second, strlen(second)}, {(void *)data, (size_t)size}};
    REAL(ssize_t, writev, int, const struct iovec *, int);
    if (real(journal, parts, data ? 4 : 3) < 0) abort();
    errno = before;
}

static struct stat about_handle(int handle) {
    struct stat about = {0};
    REAL(int, fstat, int, struct stat *);
    real(handle, &about);
    return about;
}
static int64_t inode_of(int handle) { return (int64_t)about_handle(handle).st_ino; }
static int is_folder(int handle) { return S_ISDIR(about_handle(handle).st_mode); }

static int opened(int (*real)(int, const char *, int, ...), int folder, const char *path, int flags, mode_t mode) {
    char full[PATH_MAX];
    if (!concerns(folder, path, full)) return real(folder, path, flags, mode);
    int makes = (flags & (O_CREAT | O_TRUNC)) != 0, was = faccessat(AT_FDCWD, full, F_OK, AT_SYMLINK_NOFOLLOW) == 0;
    if (hindered(!makes ? READS : was ? CHANGES : GROWS, NULL)) return -1;
    int handle = real(folder, path, flags, mode);
    if (handle >= 0 && makes) {
        if (!was) note(CREATED, inode_of(handle), full, "", 0, NULL, 0);
        else if (flags & O_TRUNC) note(TRUNCATED, inode_of(handle), full, "", 0, NULL, 0);
    }
    return handle;
}

#define MODE(flags) \
    mode_t mode = 0; \
    if ((flags) & (O_CREAT | __O_TMPFILE)) { va_list more; va_start(more, flags); mode = va_arg(more, mode_t); va_end(more); }
#define OPEN(name) \
    int name(const char *path, int flags, ...) { MODE(flags) REAL(int, openat, int, const char *, int, ...); return opened(real, AT_FDCWD, path, flags, mode); }
#define OPENAT(name) \
    int name(int folder, const char *path, int flags, ...) { MODE(flags) REAL(int, openat, int, const char *, int, ...); return opened(real, folder, path, flags, mode); }
OPEN(open)
OPEN(open64)
OPENAT(openat)
OPENAT(openat64)

/* Streams of the C library open their files inside it. */
#define FOPEN(name) \
    FILE *name(const char *path, const char *how) { \
        char full[PATH_MAX]; \
        REAL(FILE *, name, const char *, const char *); \
        if (concerns(AT_FDCWD, path, full) && hindered(*how == 'r' && !strchr(how, '+') ? READS : GROWS, NULL)) return NULL; \
        return real(path, how); \
    }
FOPEN(fopen)
FOPEN(fopen64)

static ssize_t written(int handle, const void *data, size_t size, off_t offset) {
    REAL(ssize_t, write, int, const void *, size_t);
    char full[PATH_MAX];
    if (!concerns_handle(handle, full)) return offset < 0 ? real(handle, data, size) : syscall(SYS_pwrite64, handle, data, size, offset);
    int half = 0;
    if (hindered(GROWS, &half)) return -1;
    if (half) size /= 2;
    int64_t place = offset < 0 ? (fcntl(handle, F_GETFL) & O_APPEND ? lseek(handle, 0, SEEK_END) : lseek(handle, 0, SEEK_CUR)) : offset;
    ssize_t done = offset < 0 ? real(handle, data, size) : syscall(SYS_pwrite64, handle, data, size, offset);
    if (half && control->way == KILL_HALFWAY) end_all();
    if (done > 0) note(WRITTEN, inode_of(handle), "", "", place, data, done);
    if (half && done == 0) { errno = ENOSPC; return -1; }
    return done;
}

ssize_t write(int handle, const void *data, size_t size) { return written(handle, data, size, -1); }
ssize_t pwrite(int handle, const void *data, size_t size, off_t offset) { return written(handle, data, size, offset); }
ssize_t pwrite64(int handle, const void *data, size_t size, off_t offset) { return written(handle, data, size, offset); }

/* Copies within the kernel would pass unseen: their callers then read and write. */
ssize_t sendfile(int out, int in, off_t *offset, size_t size) {
    REAL(ssize_t, sendfile, int, int, off_t *, size_t);
    char full[PATH_MAX];
    if (concerns_handle(out, full)) { errno = EINVAL; return -1; }
    return real(out, in, offset, size);
}
ssize_t sendfile64(int out, int in, off_t *offset, size_t size) { return sendfile(out, in, offset, size); }
ssize_t copy_file_range(int in, off_t *from, int out, off_t *to, size_t size, unsigned flags) {
    REAL(ssize_t, copy_file_range, int, off_t *, int, off_t *, size_t, unsigned);
    char full[PATH_MAX];
    if (concerns_handle(out, full)) { errno = EINVAL; return -1; }
    return real(in, from, out, to, size, flags);
}
ssize_t writev(int handle, const struct iovec *parts, int count) {
    REAL(ssize_t, writev, int, const struct iovec *, int);
    char full[PATH_MAX];
    if (!concerns_handle(handle, full)) return real(handle, parts, count);
    for (int i = 0; i < count; i++) /* a short write is allowed */
        if (parts[i].iov_len) return written(handle, parts[i].iov_base, parts[i].iov_len, -1);
    return 0;
}

static int flushed(int (*real)(int), int handle) {
    char full[PATH_MAX];
    if (!concerns_handle(handle, full)) return real(handle);
    if (hindered(CHANGES, NULL)) return -1;
    int done = real(handle);
    if (!done) note(is_folder(handle) ? FOLDER_FLUSHED : FLUSHED, inode_of(handle), full, "", 0, NULL, 0);
    return done;
}
int fsync(int handle) { REAL(int, fsync, int); return flushed(real, handle); }
int fdatasync(int handle) { REAL(int, fdatasync, int); return flushed(real, handle); }

/* A close that fails has closed the handle all the same; it fails where something was written. */
int close(int handle) {
    REAL(int, close, int);
    char full[PATH_MAX];
    if (!concerns_handle(handle, full) || handle == journal) return real(handle);
    if ((fcntl(handle, F_GETFL) & O_ACCMODE) == O_RDONLY) return real(handle);
    int fails = hindered(READS, NULL), error = errno, done = real(handle);
    if (fails) errno = error;
    return fails ? -1 : done;
}

static int renamed(int from, const char *old, int to, const char *new, unsigned flags) {
    REAL(int, renameat2, int, const char *, int, const char *, unsigned);
    char first[PATH_MAX], second[PATH_MAX];
    int in = concerns(from, old, first), out = concerns(to, new, second);
    if (!in && !out) return real(from, old, to, new, flags);
    if (hindered(CHANGES, NULL)) return -1;
    int done = real(from, old, to, new, flags);
    if (!done && in && out) note(RENAMED, 0, first, second, 0, NULL, 0);
    return done;
}
int rename(const char *old, const char *new) { return renamed(AT_FDCWD, old, AT_FDCWD, new, 0); }
int renameat(int from, const char *old, int to, const char *new) { return renamed(from, old, to, new, 0); }
int renameat2(int from, const char *old, int to, const char *new, unsigned flags) { return renamed(from, old, to, new, flags); }

static int unlinked(int folder, const char *path, int flags) {
    REAL(int, unlinkat, int, const char *, int);
    char full[PATH_MAX];
    if (!concerns(folder, path, full)) return real(folder, path, flags);
    if (hindered(CHANGES, NULL)) return -1;
    int done = real(folder, path, flags);
    if (!done) note(REMOVED, 0, full, "", 0, NULL, 0);
    return done;
}
int unlink(const char *path) { return unlinked(AT_FDCWD, path, 0); }
int unlinkat(int folder, const char *path, int flags) { return unlinked(folder, path, flags); }
int rmdir(const char *path) { return unlinked(AT_FDCWD, path, AT_REMOVEDIR); }

static int folder_made(int folder, const char *path, mode_t mode) {
    REAL(int, mkdirat, int, const char *, mode_t);
    char full[PATH_MAX];
    if (!concerns(folder, path, full)) return real(folder, path, mode);
    if (hindered(GROWS, NULL)) return -1;
    int done = real(folder, path, mode);
    if (!done) note(FOLDER_MADE, 0, full, "", 0, NULL, 0);
    return done;
}
int mkdir(const char *path, mode_t mode) { return folder_made(AT_FDCWD, path, mode); }
int mkdirat(int folder, const char *path, mode_t mode) { return folder_made(folder, path, mode); }

int link(const char *old, const char *new) {
    REAL(int, link, const char *, const char *);
    char first[PATH_MAX], second[PATH_MAX];
    int in = concerns(AT_FDCWD, old, first), out = concerns(AT_FDCWD, new, second);
    if (!in && !out) return real(old, new);
    if (hindered(GROWS, NULL)) return -1;
    int done = real(old, new);
    if (!done && in && out) note(LINKED, 0, first, second, 0, NULL, 0);
    return done;
}

static int cut(int handle, off_t size) {
    REAL(int, ftruncate64, int, off_t);
    char full[PATH_MAX];
    if (!concerns_handle(handle, full)) return real(handle, size);
    if (hindered(CHANGES, NULL)) return -1;
    int done = real(handle, size);
    if (!done) note(TRUNCATED, inode_of(handle), full, "", size, NULL, 0);
    return done;
}
int ftruncate(int handle, off_t size) { return cut(handle, size); }
int ftruncate64(int handle, off_t size) { return cut(handle, size); }

/* Calls without a record: what they change is no content and no name. */
#define BY_PATH(type, wrong, kind, name, declared, given) \
    type name declared { \
        REAL(type, name, PLAIN declared); \
        char full[PATH_MAX]; \
        if (concerns(AT_FDCWD, path, full) && hindered(kind, NULL)) return wrong; \
        return real given; \
    }
#define BY_HANDLE(type, wrong, kind, name, declared, given) \
    type name declared { \
        REAL(type, name, PLAIN declared); \
        char full[PATH_MAX]; \
        if (concerns_handle(handle, full) && hindered(kind, NULL)) return wrong; \
        return real given; \
    }
#define PLAIN(...) __VA_ARGS__
BY_PATH(int, -1, CHANGES, chmod, (const char *path, mode_t mode), (path, mode))
BY_HANDLE(int, -1, CHANGES, fchmod, (int handle, mode_t mode), (handle, mode))
BY_PATH(int, -1, READS, stat, (const char *path, struct stat *about), (path, about))
BY_PATH(int, -1, READS, stat64, (const char *path, struct stat64 *about), (path, about))
BY_PATH(int, -1, READS, lstat, (const char *path, struct stat *about), (path, about))
BY_PATH(int, -1, READS, lstat64, (const char *path, struct stat64 *about), (path, about))
BY_HANDLE(int, -1, READS, fstat, (int handle, struct stat *about), (handle, about))
BY_HANDLE(int, -1, READS, fstat64, (int handle, struct stat64 *about), (handle, about))
BY_PATH(int, -1, READS, access, (const char *path, int mode), (path, mode))
BY_PATH(DIR *, NULL, READS, opendir, (const char *path), (path))
BY_PATH(ssize_t, -1, READS, readlink, (const char *path, char *out, size_t size), (path, out, size))
BY_HANDLE(ssize_t, -1, READS, read, (int handle, void *data, size_t size), (handle, data, size))
BY_HANDLE(ssize_t, -1, READS, pread64, (int handle, void *data, size_t size, off_t offset), (handle, data, size, offset))
int fstatat64(int folder, const char *path, struct stat64 *about, int flags) {
    REAL(int, fstatat64, int, const char *, struct stat64 *, int);
    char full[PATH_MAX];
    if (concerns(folder, path, full) && hindered(READS, NULL)) return -1;
    return real(folder, path, about, flags);
}
int fchmodat(int folder, const char *path, mode_t mode, int flags) {
    REAL(int, fchmodat, int, const char *, mode_t, int);
    char full[PATH_MAX];
    if (concerns(folder, path, full) && hindered(CHANGES, NULL)) return -1;
    return real(folder, path, mode, flags);
}
int utimensat(int folder, const char *path, const struct timespec times[2], int flags) {
    REAL(int, utimensat, int, const char *, const struct timespec *, int);
    char full[PATH_MAX];
    if (concerns(folder, path, full) && hindered(CHANGES, NULL)) return -1;
    return real(folder, path, times, flags);
}
