// The library's instance of the function bodies in <pliant/simulate/failure_report-inl.h>.
#include <pliant/simulate/failure_report-inl.h>
