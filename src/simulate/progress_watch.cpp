// The library's instance of the function bodies in <pliant/simulate/progress_watch-inl.h>.
#include <pliant/simulate/progress_watch-inl.h>
