// The macro PLIANT_INLINE marks the function bodies in a header foo-inl.h; the header foo.h declares these
// functions. The library compiles each body once, in src. A program may need other template instances, or may
// want the compiler to inline the functions. The program then defines PLIANT_HEADER_ONLY and includes
// foo-inl.h; the functions of foo-inl.h are then inline.
#pragma once

#ifdef PLIANT_HEADER_ONLY
#define PLIANT_INLINE inline
#else
#define PLIANT_INLINE
#endif
