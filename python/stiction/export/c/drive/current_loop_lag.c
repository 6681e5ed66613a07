/* An effort that follows the input gradually. */
#define LAGS
