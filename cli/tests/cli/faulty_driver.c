/* A Vulkan driver for tests. It passes every call on to a real one, the library REAL_DRIVER, except for one function,
   FAULT_FUNCTION. From its call number FAULT_FROM on, that function does what FAULT_RESULT says: it returns this VkResult (below
   0), ends the process ("crash"), or never returns ("hang"). If FAULT_COUNT names a file, each call of the function adds a byte to
   it. Calls of a process that only tries drivers (GPU_SMOOTH_IS_TRIAL) are counted in the file FAULT_TRIALS instead.

   If FAULT_KIND is a number, the driver says that its adapters are of this VkPhysicalDeviceType: 1 is an integrated GPU, 2 a
   discrete GPU, 4 the CPU.

   The function may have up to six arguments, each an integer or a pointer, and must return a VkResult. Names and types are those
   of the interface between Vulkan's loader and its drivers, so no header is needed. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef void (*function)(void);
typedef function (*lookup)(void *, const char *);
typedef int (*six)(void *, void *, void *, void *, void *, void *);

static six real;
static atomic_int calls;
static lookup device_lookup;

static const char *setting(const char *name) {
    const char *value = getenv(name);
    return value ? value : "";
}

static function of_driver(const char *name) {
    static void *library;
    if (!library) library = dlopen(setting("REAL_DRIVER"), RTLD_NOW | RTLD_LOCAL);
    return library ? (function)dlsym(library, name) : 0;
}

static int faulty(void *a, void *b, void *c, void *d, void *e, void *f) {
    int call = atomic_fetch_add(&calls, 1) + 1;
    const char *counts = getenv("GPU_SMOOTH_IS_TRIAL") ? "FAULT_TRIALS" : "FAULT_COUNT";
    int count = open(setting(counts), O_WRONLY | O_APPEND);
    if (count >= 0) {
        if (write(count, "x", 1) < 0) abort();
        close(count);
    }
    if (call < atoi(setting("FAULT_FROM"))) return real(a, b, c, d, e, f);
    const char *result = setting("FAULT_RESULT");
    if (!strcmp(result, "crash")) abort();
    while (!strcmp(result, "hang")) pause();
    return atoi(result);
}

/* VkPhysicalDeviceProperties begins with the versions of interface and driver, two identifiers and the type.
   VkPhysicalDeviceProperties2 has a type of its own and a pointer before. */
typedef void (*description)(void *, uint32_t *);
static description describe, describe2;

static void described(void *adapter, uint32_t *properties) {
    describe(adapter, properties);
    properties[4] = (uint32_t)atoi(setting("FAULT_KIND"));
}

static void described2(void *adapter, uint32_t *properties) {
    describe2(adapter, properties);
    properties[4 + 4] = (uint32_t)atoi(setting("FAULT_KIND"));
}

static function of_device(void *device, const char *name);

static function wrapped(const char *name, function found) {
    if (!found) return found;
    if (!strcmp(name, "vkGetDeviceProcAddr")) {
        device_lookup = (lookup)found;
        return (function)of_device;
    }
    if (*setting("FAULT_KIND") && !strcmp(name, "vkGetPhysicalDeviceProperties")) {
        describe = (description)found;
        return (function)described;
    }
    if (*setting("FAULT_KIND") && !strncmp(name, "vkGetPhysicalDeviceProperties2", 30)) {
        describe2 = (description)found;
        return (function)described2;
    }
    if (strcmp(name, setting("FAULT_FUNCTION"))) return found;
    real = (six)found;
    return (function)faulty;
}

static function of_device(void *device, const char *name) {
    return wrapped(name, device_lookup(device, name));
}

function vk_icdGetInstanceProcAddr(void *instance, const char *name) {
    lookup find = (lookup)of_driver("vk_icdGetInstanceProcAddr");
    return find ? wrapped(name, find(instance, name)) : 0;
}

function vk_icdGetPhysicalDeviceProcAddr(void *instance, const char *name) {
    lookup find = (lookup)of_driver("vk_icdGetPhysicalDeviceProcAddr");
    return find ? wrapped(name, find(instance, name)) : 0;
}

int vk_icdNegotiateLoaderICDInterfaceVersion(uint32_t *version) {
    typedef int (*negotiation)(uint32_t *);
    negotiation negotiate = (negotiation)of_driver("vk_icdNegotiateLoaderICDInterfaceVersion");
    return negotiate ? negotiate(version) : -9;
}
