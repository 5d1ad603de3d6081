// PLIANT_INLINE marks the functions of the headers *-inl.h, which hold the bodies of functions that foo.h declares.
// The library compiles each body once, in src. A program that extends pliant, or wants the compiler to inline through
// it, defines PLIANT_HEADER_ONLY and includes the -inl.h itself: the functions are inline there.
#pragma once

#ifdef PLIANT_HEADER_ONLY
#define PLIANT_INLINE inline
#else
#define PLIANT_INLINE
#endif
