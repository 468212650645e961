# docker build -t toothspace . && docker run --rm -v "$PWD:/cases" toothspace run egm12_pump
FROM python:3.11-slim AS build
WORKDIR /source
COPY . .
RUN apt-get update && apt-get install -y --no-install-recommends git gcc libc6-dev \
    && pip wheel --no-cache-dir --no-deps -w /wheel .

FROM python:3.11-slim
COPY --from=build /wheel /wheel
RUN pip install --no-cache-dir /wheel/*.whl && rm -r /wheel
WORKDIR /cases
ENTRYPOINT ["toothspace"]
CMD ["--help"]
