// No include guard: a source file that defines LANDMARKDB_KERNEL_BODY includes this once, inside an
// unnamed namespace. It compiles that file for each instruction set, in a namespace of its name.

namespace sse2 {
#include LANDMARKDB_KERNEL_BODY
}  // namespace sse2

#if defined(__x86_64__)
#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
#include LANDMARKDB_KERNEL_BODY
}  // namespace avx2
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width=512")
namespace avx512 {
#include LANDMARKDB_KERNEL_BODY
}  // namespace avx512
#pragma GCC pop_options
#endif

#undef LANDMARKDB_KERNEL_BODY
